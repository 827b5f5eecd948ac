//! Seeded cases: every kind of mesh, detail and seam rule.

use std::{fmt, sync::Arc};

use displace_server::domain::{
    base::bend,
    cancel::Cancel,
    detail::{Detail, LayerSource, Map, Sampling, Wrap},
    mesh::Mesh,
    request::{Allowed, Base, Geometry, SeamRule},
};
use displace_tests::{
    maps,
    meshes::{self, TestMesh},
    surfaces::{detail, expression, uniform},
};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

/// A mesh, what is on it, and what is asked for.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) mesh: Mesh,
    pub(super) detail: Arc<Detail>,
    pub(super) geometry: Geometry,
    pub(super) allowed: Allowed,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {:?}", self.name, self.allowed)
    }
}

const EXPRESSIONS: [&str; 4] = [
    "0.4*sin(9*u+x)*cos(7*v)",
    "noise(3*x,3*y,3*z)*nx",
    "abs(u-0.4)+0.5*max(v,0.3)",
    "smoothstep(0.2,0.8,v)*exp(u)*0.4",
];

/// A map of `channels` values a texel: white noise, or a hill per period, which is smooth.
pub(super) fn map(size: u32, channels: u32, wrap: Wrap, sampling: Sampling, noise: Option<u32>) -> Arc<Map> {
    let value = |k: u32| {
        let (texel, channel) = (k / channels, k % channels);
        let (x, y) = (texel % size, texel / size);
        let turn = |x: u32| (std::f32::consts::TAU * (x as f32 / size as f32 + 0.1 * channel as f32)).sin();
        noise.map_or(0.5 + 0.4 * turn(x) * turn(y), |seed| (maps::hash(x, y, seed + channel) >> 16) as f32 / 65535.0)
    };
    let texels: Vec<f32> = (0..channels * size * size).map(value).collect();
    Arc::new(Map {
        width: size,
        height: size,
        channels,
        texels: texels.into(),
        wrap: [wrap; 2],
        sampling,
        source_bits: 32,
    })
}

fn source(random: &mut StdRng) -> (String, LayerSource) {
    let size = [4, 7, 16][random.random_range(0..3)];
    let wrap = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp][random.random_range(0..3)];
    let sampling = [Sampling::Center, Sampling::Node][random.random_range(0..2)];
    let noise = random.random_bool(0.5).then(|| random.random_range(0..1000));
    let name = |kind: &str| format!("{kind} {size} {wrap:?} {sampling:?} noise {noise:?}");
    match random.random_range(0..8) {
        0..=3 => (name("height"), LayerSource::Height(map(size, 1, wrap, sampling, noise))),
        4 => (name("tangent vectors"), LayerSource::VectorTangent(map(size, 3, wrap, sampling, noise))),
        5 => (name("object vectors"), LayerSource::VectorObject(map(size, 3, wrap, sampling, noise))),
        _ => {
            let text = EXPRESSIONS[random.random_range(0..EXPRESSIONS.len())];
            (text.into(), expression(text))
        }
    }
}

impl Case {
    /// The same over another base.
    pub(super) fn over(mut self, base: Base) -> Self {
        bend(&mut self.mesh, base, &Cancel::default()).expect("a test mesh is small");
        Self { name: format!("{} over {base:?}", self.name), geometry: Geometry { base, ..self.geometry }, ..self }
    }
}

/// Case number `seed`.
pub(super) fn seeded(seed: u64) -> Case {
    let mut random = StdRng::seed_from_u64(seed);
    let all = meshes::all();
    let mesh: &TestMesh = &all[random.random_range(0..all.len())];
    let (what, source) = source(&mut random);
    let scale = [0.02, 0.07, 0.15][random.random_range(0..3)];
    let seams = [SeamRule::Mean, SeamRule::Dominant][random.random_range(0..2)];
    let feather_texels = [0.5, 3.0, 20.0][random.random_range(0..3)];
    Case {
        name: format!("case {seed}: {} with {what}, scale {scale}, {seams:?}, feather {feather_texels}", mesh.name),
        mesh: mesh.to_mesh(),
        detail: detail(source, scale),
        geometry: Geometry { seams, feather_texels, ..uniform(0) },
        allowed: Allowed::Diagonal([0.02, 0.01, 0.005][random.random_range(0..3)]),
    }
}
