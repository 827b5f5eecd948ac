//! The tables, streams and passes that bend normals.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    expression::Instruction,
    layout::{
        bump::{BUMP_SLOTS, Bump, BumpExpressionParams, BumpFormula, BumpParams, MOST_FORMULAS},
        raster::MAP_DETAIL,
    },
};

use crate::{
    domain::{
        Error, Result,
        image::{RenderBump, RenderScene},
    },
    vulkan::{Device, Recorder, Stream},
};

use super::Frame;

/// Of all materials, in their order; empty where nothing bends.
#[derive(Debug, Default)]
pub(crate) struct BumpTables {
    pub(crate) bumps: Vec<Bump>,
    pub(crate) formulas: Vec<BumpFormula>,
    pub(crate) instructions: Vec<Instruction>,
}

impl BumpTables {
    pub(crate) fn new(scene: &RenderScene) -> Result<Self> {
        let mut tables = Self::default();
        if !scene.is_bumped() {
            return Ok(tables);
        }
        for material in &scene.materials {
            let bump = tables.bump(&material.bump)?;
            tables.bumps.push(bump);
        }
        Ok(tables)
    }

    fn bump(&mut self, bump: &RenderBump) -> Result<Bump> {
        if bump.formulas.len() > MOST_FORMULAS {
            return Err(Error::internal(format!("a material is bent by more than {MOST_FORMULAS} formulas")));
        }
        let expression_first = self.formulas.len() as u32;
        for formula in &bump.formulas {
            self.formulas.push(BumpFormula {
                map_u: formula.map_from_uv[0],
                map_v: formula.map_from_uv[1],
                uv_channel: formula.uv_channel,
                first: self.instructions.len() as u32,
                count: formula.program.code.len() as u32,
                scale: formula.scale,
            });
            self.instructions.extend_from_slice(&formula.program.code);
        }
        Ok(Bump {
            kinds: bump.uses.map(|used| used.kind.number()),
            scales: bump.uses.map(|used| used.scale),
            expression_first,
            expression_count: bump.formulas.len() as u32,
            flags: bump.flags(),
        })
    }

    /// The formulas of a material.
    pub(crate) fn formulas_of(&self, material: usize) -> impl Iterator<Item = (&BumpFormula, &[Instruction])> {
        let range = self.bumps.get(material).map_or(0..0, |b| {
            let first = b.expression_first as usize;
            first..first + b.expression_count as usize
        });
        self.formulas[range].iter().map(|formula| {
            let first = formula.first as usize;
            (formula, &self.instructions[first..first + formula.count as usize])
        })
    }
}

pub(crate) struct BumpStreams {
    pub(crate) bumps: Stream,
    formulas: Stream,
    instructions: Stream,
}

impl BumpStreams {
    pub(crate) fn upload(device: &Arc<Device>, tables: &BumpTables) -> Result<Self> {
        Ok(Self {
            bumps: Stream::from_slice(device, "bumps", &tables.bumps)?,
            formulas: Stream::from_slice(device, "formulas", &tables.formulas)?,
            instructions: Stream::from_slice(device, "formula instructions", &tables.instructions)?,
        })
    }
}

/// Bends the normals of the first `count` fragments, once their appearance is known; nothing where no material does.
pub(crate) fn record(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, tables, streams, work, .. } = frame;
    if tables.bump.bumps.is_empty() {
        return Ok(());
    }
    if !tables.bump.formulas.is_empty() {
        record_formulas(recorder, frame, count)?;
    }
    let has_map = |slot: &usize| !work.mapped[MAP_DETAIL + slot].is_empty();
    let params = BumpParams {
        count: count as u32,
        maps: (0..BUMP_SLOTS).filter(has_map).fold(0, |bits, slot| bits | 1 << slot),
        uv_channels: scene.uv_channels,
        has_tangents: u32::from(!streams.tangents.is_empty()),
        has_rises: u32::from(!tables.bump.formulas.is_empty()),
    };
    let bound = [
        ("points", &work.points),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("uvs", &streams.uvs),
        ("tangents", &streams.tangents),
        ("instance_rows", &streams.instance_rows),
        ("maps", &streams.texture_uses),
        ("bumps", &streams.bump.bumps),
        ("mapped_detail_0", &work.mapped[MAP_DETAIL]),
        ("mapped_detail_1", &work.mapped[MAP_DETAIL + 1]),
        ("mapped_detail_2", &work.mapped[MAP_DETAIL + 2]),
        ("mapped_detail_3", &work.mapped[MAP_DETAIL + 3]),
        ("rises", &work.rises),
        ("appearances", &work.appearances),
    ];
    Ok(recorder.dispatch(&SHADERS.bump, count, &params, &bound)?)
}

fn record_formulas(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let params = BumpExpressionParams { count: count as u32, uv_channels: scene.uv_channels };
    let bound = [
        ("points", &work.points),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("uvs", &streams.uvs),
        ("bumps", &streams.bump.bumps),
        ("formulas", &streams.bump.formulas),
        ("instructions", &streams.bump.instructions),
        ("rises", &work.rises),
    ];
    Ok(recorder.dispatch(&SHADERS.bump_expression, count, &params, &bound)?)
}
