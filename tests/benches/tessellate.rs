//! The tessellator on the device against the f64 twins on all cores: the height fields of the corpus as two triangles, at
//! a tolerance of 0.002 of their range.
//!
//! The two run in turn on the same cores; the ratio of the medians is what counts. A first run of the device compiles its
//! passes and is told apart.
//!
//! `DISPLACE_CORPUS=... cargo bench --profile dev --workspace --bench tessellate`

use std::{path::Path, sync::Arc, time::Instant};

use displace_glsl::tables::Tables;
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Detail, Layer, LayerSource, Map, Sampling, Wrap},
        mesh::Mesh,
        plan::TolerancePlan,
        request::{ErrorAt, Quality},
    },
    render::{
        JobContext, passes,
        tessellate::{Tessellated, device, tessellate},
    },
    vulkan::{Device, DeviceOptions},
};
use displace_tests::{
    corpus::corpus,
    meshes,
    surfaces::{plan, uniform},
};

const SHARE_OF_RANGE: f64 = 0.002;
const RUNS: usize = 3;

fn main() {
    let Some(corpus) = corpus("the bench of the tessellator") else { return };
    let vulkan = Device::open(&DeviceOptions::default()).expect("a Vulkan device");
    println!("device {}", vulkan.info().name);
    for (first, name) in [(true, "waves"), (false, "d14"), (false, "fbm"), (false, "bricks")] {
        let field = Field::read(&corpus.path(&format!("heightfields/{name}_513.exr")));
        if first {
            println!("first run {:.0} ms", field.on_device(&vulkan).ms);
        }
        field.compare(name, &vulkan);
    }
}

struct Field {
    mesh: Mesh,
    tables: Tables,
    plan: TolerancePlan,
}

/// One tessellation.
struct Run {
    ms: f64,
    triangles: usize,
    /// Of refinement and of collapses.
    steps_ms: [f64; 2],
}

impl Field {
    fn read(path: &Path) -> Self {
        let map = map(path);
        let range = |pick: fn(f32, f32) -> f32, from: f32| f64::from(map.texels.iter().copied().fold(from, pick));
        let range = range(f32::max, f32::MIN) - range(f32::min, f32::MAX);
        let mesh = meshes::plane(1).to_mesh_without_tangents();
        let map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let layer = Layer { source: LayerSource::Height(Arc::new(map)), scale: 1.0, midlevel: 0.0, map_from_uv };
        let detail = Arc::new(Detail { layers: vec![layer], uv_set: 0 });
        let uniform = plan(&mesh, &uniform(0)).expect("fits");
        let tables = passes::tables::build(&uniform, &mesh, &[Some(detail)]).expect("tables");
        Self { mesh, tables, plan: within(SHARE_OF_RANGE * range) }
    }

    fn on_device(&self, vulkan: &Arc<Device>) -> Run {
        run(|job| device::tessellate(vulkan, job, &self.plan, &self.tables, &self.mesh))
    }

    fn on_host(&self) -> Run {
        run(|job| tessellate(job, &self.plan, &self.tables, &self.mesh))
    }

    fn compare(&self, name: &str, vulkan: &Arc<Device>) {
        let runs: Vec<[Run; 2]> = (0..RUNS).map(|_| [self.on_device(vulkan), self.on_host()]).collect();
        let median = |of: &dyn Fn(&[Run; 2]) -> f64| {
            let mut values: Vec<f64> = runs.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        for (k, what) in ["device", "host"].into_iter().enumerate() {
            let [refine, collapse] = [0, 1].map(|step| median(&|runs| runs[k].steps_ms[step]));
            let (all, triangles) = (median(&|runs| runs[k].ms), runs[0][k].triangles);
            println!(
                "{name:<7} {what:<6} {triangles:7} triangles {all:8.0} ms: refine {refine:7.0}, collapse {collapse:7.0}"
            );
        }
        println!("{name:<7} device : host {:.2}", median(&|[device, host]| device.ms / host.ms));
    }
}

fn run(work: impl FnOnce(&JobContext<'_>) -> displace_server::domain::Result<Tessellated>) -> Run {
    let start = Instant::now();
    let made = work(&JobContext { cancel: &Cancel::default(), progress: &NoProgress }).expect("runs");
    let step = |name: &str| made.times.iter().filter(|time| time.name == name).map(|time| time.ms).sum();
    let steps_ms = ["refine", "collapse"].map(step);
    Run { ms: start.elapsed().as_secs_f64() * 1e3, triangles: made.mesh.triangles.len(), steps_ms }
}

fn within(tolerance_local: f64) -> TolerancePlan {
    TolerancePlan {
        tolerance_local,
        unit_per_local: 1.0,
        views: Vec::new(),
        error_at: ErrorAt::Surface,
        quality: Quality::Normal,
        max_triangles: 1 << 24,
        spans_base: false,
        reserve: None,
    }
}

fn map(path: &Path) -> Map {
    let image = exr::prelude::read_first_flat_layer_from_file(path).expect("a height field");
    let exr::prelude::Vec2(width, height) = image.layer_data.size;
    let texels: Vec<f32> = image.layer_data.channel_data.list[0].sample_data.values_as_f32().collect();
    let wrap = [Wrap::Clamp; 2];
    let (width, height) = (width as u32, height as u32);
    Map { width, height, channels: 1, texels: texels.into(), wrap, sampling: Sampling::Node, source_bits: 32 }
}
