//! Attribute vertices: wedges of one primitive with equal place and equal attribute bits are one.

use std::{collections::HashMap, ops::Range};

use rayon::prelude::*;

use super::{PrimitiveInput, VertexAttribute, canonical_bits, tangents::repaired_tangent, wedges::Wedges};
use crate::domain::mesh::Attribute;

pub(super) struct Looks {
    pub(super) av_gv: Vec<u32>,
    pub(super) av_normal: Vec<[f32; 3]>,
    pub(super) av_tangent: Vec<[f32; 4]>,
    pub(super) attributes: Vec<Attribute>,
    pub(super) av_of_wedge: Vec<Vec<u32>>,
    pub(super) avs_of_primitive: Vec<Range<u32>>,
}

pub(super) fn weld(primitives: &[PrimitiveInput], wedges: &[Wedges]) -> Looks {
    let attributes = union(primitives);
    let parts: Vec<Part> =
        primitives.par_iter().zip(wedges).map(|(input, wedges)| Part::new(input, wedges, &attributes)).collect();
    let mut looks = Looks {
        av_gv: Vec::new(),
        av_normal: Vec::new(),
        av_tangent: Vec::new(),
        attributes,
        av_of_wedge: Vec::new(),
        avs_of_primitive: Vec::new(),
    };
    let tangents = primitives.iter().any(|p| p.tangents.is_some());
    for (part, wedges) in parts.into_iter().zip(wedges) {
        looks.append(part, wedges, tangents);
    }
    looks
}

/// Every semantic that any primitive has, in the order of [`order`], with the most components it has.
pub(super) fn union(primitives: &[PrimitiveInput]) -> Vec<Attribute> {
    let mut index_of = HashMap::<&str, usize>::new();
    let mut attributes: Vec<Attribute> = Vec::new();
    for (p, attribute) in
        primitives.iter().enumerate().flat_map(|(p, input)| input.attributes.iter().map(move |a| (p, a)))
    {
        let known = *index_of.entry(&attribute.semantic).or_insert_with(|| {
            let semantic = attribute.semantic.clone();
            attributes.push(Attribute {
                semantic,
                components: 0,
                values: Vec::new(),
                primitives: vec![false; primitives.len()],
            });
            attributes.len() - 1
        });
        attributes[known].components = attributes[known].components.max(attribute.components);
        attributes[known].primitives[p] = true;
    }
    attributes.sort_by_cached_key(|a| order(&a.semantic));
    attributes
}

/// UV sets first, then colours, skins, custom attributes, morph targets; numbers count as numbers.
fn order(semantic: &str) -> (usize, u32, String) {
    let (set, number) = semantic.rsplit_once('_').unwrap_or((semantic, ""));
    let class = match set {
        "TEXCOORD" => 0,
        "COLOR" => 1,
        "JOINTS" => 2,
        "WEIGHTS" => 3,
        _ if semantic.starts_with("targets/") => 5,
        _ => 4,
    };
    let target = semantic.split('/').nth(1).unwrap_or(number);
    (class, target.parse().unwrap_or(u32::MAX), semantic.into())
}

/// The distinct looks of one primitive.
struct Part {
    /// One wedge of each look, in the order of (gv, bits).
    representatives: Vec<u32>,
    look_of_wedge: Vec<u32>,
    /// Attribute words of every wedge: normal, tangent, then the union's attributes.
    rows: Vec<u32>,
    row_words: usize,
}

impl Part {
    fn new(input: &PrimitiveInput, wedges: &Wedges, attributes: &[Attribute]) -> Self {
        let (rows, row_words) = rows(input, wedges, attributes);
        let row = |wedge: u32| &rows[wedge as usize * row_words..][..row_words];
        let mut used = vec![false; wedges.gv.len()];
        wedges.triangles.iter().flatten().for_each(|&w| used[w as usize] = true);
        let mut order: Vec<u32> = (0..wedges.gv.len() as u32).filter(|&w| used[w as usize]).collect();
        let gv = |wedge: u32| wedges.gv[wedge as usize];
        order.par_sort_unstable_by(|&a, &b| gv(a).cmp(&gv(b)).then_with(|| row(a).cmp(row(b))));
        let mut look_of_wedge = vec![0; wedges.gv.len()];
        let mut representatives: Vec<u32> = Vec::new();
        for wedge in order {
            let same = representatives.last().is_some_and(|&last| gv(last) == gv(wedge) && row(last) == row(wedge));
            if !same {
                representatives.push(wedge);
            }
            look_of_wedge[wedge as usize] = representatives.len() as u32 - 1;
        }
        Self { representatives, look_of_wedge, rows, row_words }
    }

    fn row(&self, wedge: u32) -> &[u32] {
        &self.rows[wedge as usize * self.row_words..][..self.row_words]
    }
}

/// Words of normal and tangent (handedness first) at the start of a row.
pub(super) const FIXED_WORDS: usize = 7;

fn rows(input: &PrimitiveInput, wedges: &Wedges, attributes: &[Attribute]) -> (Vec<u32>, usize) {
    let own: HashMap<&str, &VertexAttribute> = input.attributes.iter().map(|a| (a.semantic.as_str(), a)).collect();
    let of_union: Vec<_> = attributes.iter().map(|a| (a, own.get(a.semantic.as_str()))).collect();
    let row_words = FIXED_WORDS + attributes.iter().map(|a| a.components).sum::<usize>();
    let mut rows = vec![0u32; row_words * wedges.gv.len()];
    rows.par_chunks_mut(row_words).enumerate().for_each(|(wedge, row)| {
        let vertex = wedges.source(wedge as u32);
        let normal = wedges.normals[wedge];
        let tangent = input.tangents.as_ref().map_or([0.0; 4], |t| repaired_tangent(t[vertex], normal));
        let mut words = row.iter_mut();
        let mut put = |value: f32| words.next().into_iter().for_each(|word| *word = canonical_bits(value));
        // Handedness first: made tangents vary in their last bits with the order of the triangles, and the order of
        // looks must not.
        let [x, y, z, handedness] = tangent;
        normal.into_iter().chain([handedness, x, y, z]).for_each(&mut put);
        for (attribute, own) in &of_union {
            let Some(own) = own else {
                (0..attribute.components).for_each(|_| put(0.0));
                continue;
            };
            let missing = padding(attribute) as f32;
            let values = &own.values[vertex * own.components..][..own.components];
            values.iter().copied().chain(std::iter::repeat(missing)).take(attribute.components).for_each(&mut put);
        }
    });
    (rows, row_words)
}

/// What a component counts as that another primitive of the mesh has and this one lacks: opaque alpha.
fn padding(attribute: &Attribute) -> u8 {
    u8::from(attribute.semantic.starts_with("COLOR_"))
}

impl Looks {
    fn append(&mut self, part: Part, wedges: &Wedges, tangents: bool) {
        let first = self.av_gv.len() as u32;
        self.av_gv.extend(part.representatives.iter().map(|&w| wedges.gv[w as usize]));
        let floats = |range: Range<usize>, wedge: u32| part.row(wedge)[range].iter().map(|&bits| f32::from_bits(bits));
        for &wedge in &part.representatives {
            self.av_normal.push(array(floats(0..3, wedge)));
            if tangents {
                let [handedness, x, y, z] = array(floats(3..7, wedge));
                self.av_tangent.push([x, y, z, handedness]);
            }
        }
        let mut start = FIXED_WORDS;
        for attribute in &mut self.attributes {
            let words = start..start + attribute.components;
            start = words.end;
            attribute.values.extend(part.representatives.iter().flat_map(|&wedge| floats(words.clone(), wedge)));
        }
        self.av_of_wedge.push(part.look_of_wedge.iter().map(|look| first + look).collect());
        self.avs_of_primitive.push(first..self.av_gv.len() as u32);
    }
}

fn array<const N: usize>(values: impl Iterator<Item = f32>) -> [f32; N] {
    let mut array = [0.0; N];
    array.iter_mut().zip(values).for_each(|(slot, value)| *slot = value);
    array
}
