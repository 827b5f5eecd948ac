//! Device against f64 twin, pass by pass and as a whole.

use std::sync::Arc;

use displace_glsl::{
    layout::geometry::{self as layout, block, kind},
    reference::{
        displace, displace_expression, displace_vector,
        frame::Jet,
        jets_expression, jets_height, jets_vector, normals_analytic, normals_geometric,
        samples::Sample,
        subdivide::{self, Base},
        triangles,
    },
    tables::Tables,
};
use displace_server::{
    domain::{
        detail::{Detail, LayerSource, Sampling, Wrap},
        mesh::Mesh,
        plan::SurfacePlan,
    },
    render::{
        passes::{
            self,
            jets::{Domain, Jets, all_details},
            streams::{BaseStreams, FineStreams, SampleStreams},
            subdivide::blocks,
        },
        reference::places,
    },
    vulkan::{Recorder, Stream},
};
use displace_tests::meshes;
use glam::{DMat3, DVec3, DVec4};

use super::*;

/// Half a unit in the last place of 1.
const EPSILON: f64 = 5.960_464_5e-8;

/// One mesh with one detail on the device, pass by pass.
struct Bench {
    mesh: Mesh,
    tables: Tables,
    base: BaseStreams,
    fine: FineStreams,
    plan: SurfacePlan,
}

impl Bench {
    fn new(mesh: Mesh, level: u32, detail: Option<&Arc<Detail>>) -> Self {
        let plan = planned(&mesh, &geometry(level));
        let tables =
            passes::tables::build(&plan, &mesh, &vec![detail.cloned(); mesh.primitives.len()]).expect("tables");
        let device = vulkan().device();
        let base = BaseStreams::new(device, &tables).expect("fits");
        let fine = FineStreams::new(device, &plan, &tables).expect("fits");
        Self { mesh, tables, base, fine, plan }
    }

    fn record(&self, work: impl FnOnce(&mut Recorder<'_>)) {
        let (cancel, progress) = (Cancel::default(), NoProgress);
        let mut recorder = vulkan().device().recorder(&cancel, &progress);
        work(&mut recorder);
        recorder.finish().expect("runs");
    }

    fn subdivide(&self) {
        self.record(|r| passes::subdivide::record(r, &self.tables, &self.base, &self.fine).expect("records"));
    }

    fn displace(&self) {
        self.record(|r| {
            passes::displace::record(r, &self.tables, &self.mesh, &self.base, &self.fine).expect("records")
        });
    }

    /// Every fine vertex with its block and its number there.
    fn vertices(&self) -> Vec<(u32, u32)> {
        blocks(&self.tables).into_iter().flat_map(|(b, _, count)| (0..count as u32).map(move |i| (b, i))).collect()
    }

    /// What `subdivide` wrote, exactly.
    fn device_base(&self) -> Vec<Base> {
        let p: Vec<[f32; 4]> = read(&self.fine.base_position_u);
        let d: Vec<[f32; 4]> = read(&self.fine.base_direction_v);
        let n: Vec<[f32; 3]> = read(&self.fine.base_normals);
        let t: Vec<[f32; 4]> = read(&self.fine.base_tangents);
        let base = |i: usize| Base {
            position: vec3(&p[i]),
            direction: vec3(&d[i]),
            uv: [f64::from(p[i][3]), f64::from(d[i][3])],
            normal: n.get(i).map_or(DVec3::ZERO, vec3),
            tangent: t.get(i).map_or(DVec4::ZERO, |t| vec3(t).extend(f64::from(t[3]))),
        };
        (0..p.len()).map(base).collect()
    }

    fn samples(&self, which: u32, start: u64, count: u64) -> (Vec<Sample>, Vec<Jet>) {
        let chunk = SampleStreams::new(vulkan().device(), &self.tables, count).expect("fits");
        let jets =
            Jets { tables: &self.tables, base: &self.base, av_correction: &self.fine.av_correction, chunk: &chunk };
        let details = all_details(&self.tables);
        let domain = Domain { block: which, start, count, details, hats: false, ramps: false };
        self.record(|r| jets.record(r, &domain).expect("records"));
        let samples: Vec<layout::Sample> = read(&chunk.samples);
        let values: Vec<[f32; 9]> = read(&chunk.jets);
        let jet = |m: &[f32; 9]| DMat3::from_cols_array(&m.map(f64::from));
        (samples.iter().map(Sample::from_device).collect(), values.iter().map(jet).collect())
    }
}

fn read<T: bytemuck::Pod>(stream: &Stream) -> Vec<T> {
    stream.read().expect("reads")
}

fn vec3<const N: usize>(v: &[f32; N]) -> DVec3 {
    displace_glsl::reference::site::vector(v)
}

fn meshes_and_levels() -> Vec<(Mesh, u32)> {
    let mut all: Vec<(Mesh, u32)> = meshes::all().iter().map(|m| (welded_with_tangents(m), 3)).collect();
    all.push((welded_with_tangents(&meshes::plane(1)), 7));
    all.push((welded_with_tangents(&meshes::torus(5, 4)), 0));
    all.push((welded_with_tangents(&meshes::torus(5, 4)), 1));
    all
}

/// Details of every kind.
fn details() -> Vec<(&'static str, Arc<Detail>)> {
    let object = |map| detail([layer(LayerSource::VectorObject(Arc::new(map)), 0.1, 0.5)]);
    let tangent = |map| detail([layer(LayerSource::VectorTangent(Arc::new(map)), 0.1, 0.5)]);
    let wrapped = |wrap, sampling, size| {
        let mut map = noise(size, 1);
        (map.wrap, map.sampling) = (wrap, sampling);
        height(map, 0.1)
    };
    vec![
        ("height", height(noise([64, 64], 1), 0.1)),
        ("odd height, mirrored", wrapped([Wrap::Mirror, Wrap::Repeat], Sampling::Center, [13, 7])),
        ("nodes, clamped", wrapped([Wrap::Clamp; 2], Sampling::Node, [17, 5])),
        ("nodes, repeated", wrapped([Wrap::Repeat, Wrap::Mirror], Sampling::Node, [9, 6])),
        ("object vectors", object(noise([32, 16], 3))),
        ("tangent vectors", tangent(noise([32, 16], 3))),
        ("expression", expression("0.3*sin(20*pi*u)*cos(7*y) + 0.1*nz^2 + noise(4*x, 4*y, 4*z)", 0.1)),
        (
            "three layers",
            detail([
                layer(LayerSource::Height(Arc::new(noise([16, 16], 1))), 0.05, 0.5),
                layer(LayerSource::VectorTangent(Arc::new(noise([8, 8], 3))), 0.02, 0.5),
                layer(
                    LayerSource::Expression(Arc::new(Program::parse("exp(-x*x) * smoothstep(0, 1, v)").unwrap())),
                    0.1,
                    0.0,
                ),
            ]),
        ),
    ]
}

#[test]
fn subdivide_agrees_with_its_twin() {
    let (_, tangent) = details().swap_remove(5);
    for (mesh, level) in meshes_and_levels() {
        let bench = Bench::new(mesh, level, Some(&tangent));
        bench.subdivide();
        for (device, (which, index)) in bench.device_base().iter().zip(bench.vertices()) {
            let twin = subdivide::base(&bench.tables, which, index);
            let place = format!("{} block {which} vertex {index}", bench.mesh.name);
            // Three products and two sums of numbers up to 2.
            assert!(device.position.distance(twin.position) <= 8.0 * EPSILON * 2.0, "{place}: position");
            assert!(
                (device.uv[0] - twin.uv[0]).abs().max((device.uv[1] - twin.uv[1]).abs()) <= 4.0 * EPSILON,
                "{place}: uv"
            );
            // A quotient by a length: the errors of the blend over its shortest length.
            let shortest = 0.125;
            assert!(device.direction.distance(twin.direction) <= 16.0 * EPSILON / shortest, "{place}: direction");
            assert!(device.normal.distance(twin.normal) <= 16.0 * EPSILON / shortest, "{place}: normal");
            assert!(
                device.tangent.distance(twin.tangent) <= 1e-4,
                "{place}: tangent {} {}",
                device.tangent,
                twin.tangent
            );
        }
    }
}

#[test]
fn displacement_agrees_with_its_twins() {
    for (name, detail) in details() {
        for (mesh, level) in meshes_and_levels() {
            let bench = Bench::new(mesh, level, Some(&detail));
            bench.subdivide();
            bench.displace();
            let positions: Vec<[f32; 3]> = read(&bench.fine.positions);
            for (base, position) in bench.device_base().iter().zip(&positions) {
                let offset = |layer| match bench.tables.layers[layer as usize].kind {
                    kind::HEIGHT => displace::displacement(&bench.tables, &bench.tables.layers[layer as usize], base),
                    kind::EXPRESSION => {
                        displace_expression::displacement(&bench.tables, &bench.tables.layers[layer as usize], base)
                    }
                    _ => displace_vector::displacement(&bench.tables, &bench.tables.layers[layer as usize], base),
                };
                let twin = base.position + bench.tables.details[1].clone().map(offset).sum::<DVec3>();
                // Texel space reaches 64 and noise climbs by 1 a texel; sines see arguments up to 63.
                let bound = 0.1 * (64.0 * 8.0 * EPSILON) * base.direction.length().max(1.0) + 8.0 * EPSILON;
                let error = vec3(position).distance(twin);
                assert!(error <= bound, "{name} on {}: {error:e} above {bound:e}", bench.mesh.name);
            }
        }
    }
}

#[test]
fn jets_agree_with_their_twins() {
    for (name, detail) in details() {
        for (mesh, level) in meshes_and_levels() {
            let bench = Bench::new(mesh, level, Some(&detail));
            let points = displace_glsl::lattice::edge_points(level);
            let corner_items = u64::from(bench.tables.contribution_first[bench.tables.lattice.corners as usize]);
            let edge_items = bench.tables.contributions.len() as u64 - corner_items;
            for (which, start, count) in [
                (block::CORNERS, 0, corner_items),
                (block::EDGES, corner_items * points, edge_items * points),
                (block::INTERIORS, 0, blocks(&bench.tables)[2].2),
            ] {
                check_jets(name, &bench, which, start, count);
            }
        }
    }
}

fn check_jets(name: &str, bench: &Bench, which: u32, start: u64, count: u64) {
    if count == 0 {
        return;
    }
    let (samples, jets) = bench.samples(which, start, count);
    for (sample, jet) in samples.iter().zip(jets) {
        let twin: Jet = bench.tables.details[sample.detail as usize]
            .clone()
            .map(|layer| match &bench.tables.layers[layer as usize] {
                l if l.kind == kind::HEIGHT => jets_height::jet(&bench.tables, l, sample),
                l if l.kind == kind::EXPRESSION => jets_expression::jet(&bench.tables, l, sample),
                l => jets_vector::jet(&bench.tables, l, sample),
            })
            .fold(Jet::ZERO, |sum, jet| sum + jet);
        // Slopes are values times texels per triangle (up to 64) or the frequency (20 pi); twice as
        // uncertain as values.
        let size = twin.to_cols_array().iter().fold(1.0f64, |m, x| m.max(x.abs()));
        let error = (jet - twin).to_cols_array().iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let bound = 64.0 * 64.0 * EPSILON * size;
        assert!(
            error <= bound,
            "{name} on {} block {which}: {error:e} above {bound:e}\n{jet}\n{twin}",
            bench.mesh.name
        );
    }
}

#[test]
fn normals_agree_with_their_twins() {
    let (_, detail) = details().swap_remove(0);
    for (mesh, level) in meshes_and_levels() {
        let bench = Bench::new(mesh, level, Some(&detail));
        bench.subdivide();
        bench.displace();
        let positions: Vec<[f32; 3]> = read(&bench.fine.positions);
        bench.record(|r| {
            passes::normals::record_geometric(r, &bench.tables, &bench.base, &bench.fine).expect("records")
        });
        let geometric: Vec<[f32; 3]> = read(&bench.fine.normals);
        for (normal, (which, index)) in geometric.iter().zip(bench.vertices()) {
            let twin = normals_geometric::normal(&bench.tables, which, index, |v| vec3(&positions[v as usize]));
            // Edges are differences of near positions: they keep 2^-24 of 2 over their length.
            let error = vec3(normal).distance(twin);
            assert!(error < 2e-4, "{} geometric {which}/{index}: {error:e}", bench.mesh.name);
        }
    }
}

#[test]
fn analytic_normals_agree_with_their_twin_given_the_same_jets() {
    let (_, detail) = details().swap_remove(0);
    for (mesh, level) in meshes_and_levels() {
        let mut bench = Bench::new(mesh, level, Some(&detail));
        // Without corrections the jets are those of the samples themselves.
        let mut g = geometry(level);
        g.feather_texels = 0.0;
        bench.plan = planned(&bench.mesh, &g);
        bench.tables =
            passes::tables::build(&bench.plan, &bench.mesh, &vec![Some(detail.clone()); bench.mesh.primitives.len()])
                .expect("tables");
        bench.base = BaseStreams::new(vulkan().device(), &bench.tables).expect("fits");
        bench.record(|r| {
            passes::normals::record_analytic(vulkan().device(), r, &bench.tables, &bench.base, &bench.fine)
                .expect("records");
        });
        let normals: Vec<[f32; 3]> = read(&bench.fine.normals);
        let jet = |(t, ij): (u32, [u32; 2])| {
            let n = f64::from(bench.tables.segments());
            let triangle = bench.tables.base_triangles[t as usize];
            let params = layout::SamplesParams { side: layout::OWN, ..Default::default() };
            let [b1, b2] = ij.map(|x| f64::from(x) / n);
            let sample =
                displace_glsl::reference::samples::vertex_sample(&bench.tables, &params, t, b1, b2).expect("own");
            assert_eq!(triangle.detail, sample.detail);
            (sample, jets_height::jet(&bench.tables, &bench.tables.layers[0], &sample))
        };
        for (normal, (which, index)) in normals.iter().zip(bench.vertices()) {
            let contributions: Vec<(Sample, Jet)> = places(&bench.tables, which, index).into_iter().map(jet).collect();
            let twin =
                normals_analytic::normal(&bench.tables, (which == block::CORNERS).then_some(index), &contributions);
            let error = vec3(normal).distance(twin);
            assert!(error < 2e-4, "{} analytic {which}/{index}: {error:e} {normal:?} {twin}", bench.mesh.name);
        }
    }
}

#[test]
fn triangles_are_those_of_the_twin() {
    for (mesh, level) in meshes_and_levels() {
        let bench = Bench::new(mesh, level, None);
        bench.subdivide();
        bench.displace();
        bench.record(|r| passes::triangles::record(r, &bench.tables, &bench.base, &bench.fine).expect("records"));
        let device: Vec<[u32; 3]> = read(&bench.fine.triangles);
        for (t, ids) in device.iter().enumerate() {
            assert_eq!(*ids, triangles::triangle(&bench.tables, t as u32), "{} triangle {t}", bench.mesh.name);
        }
        assert_eq!(read::<u32>(&bench.fine.counters), [0, 0, 0], "{}", bench.mesh.name);
    }
}

/// The whole pipeline: corrections, ramps and all.
#[test]
fn whole_surfaces_agree_with_the_reference() {
    for (name, detail) in details() {
        for (mesh, level) in meshes_and_levels() {
            for (seams, feather) in [(SeamRule::Mean, 3.0), (SeamRule::Dominant, 3.0), (SeamRule::Mean, 0.0)] {
                let g = Geometry { seams, feather_texels: feather, ..geometry(level) };
                let [device, twin] = on_both(&mesh, &g, Some(&detail));
                let what = format!("{name} on {} level {level} {seams:?} feather {feather}", mesh.name);
                let error = worst(&device.positions, &twin.positions);
                assert!(error < 2e-5, "{what}: positions {error:e}");
                assert_eq!(device.triangles, twin.triangles, "{what}");
                let uv = device.attributes[0]
                    .iter()
                    .zip(&twin.attributes[0])
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f32::max);
                assert!(uv <= 4.0 * EPSILON as f32, "{what}: uv {uv:e}");
                assert!((device.mismatch_max - twin.mismatch_max).abs() < 2e-5, "{what}: mismatch");
                let mut errors: Vec<f32> =
                    device.normals.iter().zip(&twin.normals).map(|(a, b)| distance(*a, *b)).collect();
                errors.sort_by(f32::total_cmp);
                // Where a surface nearly folds, its normal hangs on the last bits: all but a few are compared.
                let nearly_all = errors[(errors.len() - 1) * 999 / 1000];
                assert!(nearly_all < 1e-3, "{what}: normals {nearly_all:e} {:e}", errors[errors.len() - 1]);
            }
        }
    }
}
