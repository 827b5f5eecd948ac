//! The tessellator on the device against the f64 twins on all cores: the height fields of the corpus, at a tolerance of
//! 0.002 of their range.
//!
//! `DISPLACE_CORPUS=... cargo bench --profile dev --workspace --bench tessellate`

use std::{
    path::Path,
    sync::{Arc, Mutex},
    time::Instant,
};

use displace_glsl::{
    reference::{bound::Asked, place::Places},
    tables::Tables,
};
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress, Progress},
        detail::{Detail, Layer, LayerSource, Map, Sampling, Wrap},
        mesh::Mesh,
        plan::TolerancePlan,
        request::{ErrorAt, Quality},
    },
    render::{
        JobContext, passes, refine,
        tessellate::{self, device},
    },
    vulkan::{Device, DeviceOptions},
};
use displace_tests::{
    corpus::corpus,
    meshes,
    surfaces::{plan, uniform},
};

const SHARE_OF_RANGE: f64 = 0.002;
/// Of the tolerance, as the tessellator starts its collapses from.
const START: f64 = 0.85;

fn main() {
    let Some(corpus) = corpus("the bench of the tessellator") else { return };
    let device = Device::open(&DeviceOptions::default()).expect("a Vulkan device");
    println!("device {}", device.info().name);
    for name in ["waves", "d14", "fbm", "bricks"] {
        let field = Field::read(&corpus.path(&format!("heightfields/{name}_513.exr")));
        field.compare(name, &device);
    }
}

struct Field {
    mesh: Mesh,
    tables: Tables,
    tolerance: f64,
}

impl Field {
    fn read(path: &Path) -> Self {
        let map = map(path);
        let range = |pick: fn(f32, f32) -> f32, from: f32| f64::from(map.texels.iter().copied().fold(from, pick));
        let tolerance = SHARE_OF_RANGE * (range(f32::max, f32::MIN) - range(f32::min, f32::MAX));
        let mesh = meshes::plane(1).to_mesh_without_tangents();
        let map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let layer = Layer { source: LayerSource::Height(Arc::new(map)), scale: 1.0, midlevel: 0.0, map_from_uv };
        let detail = Arc::new(Detail { layers: vec![layer], uv_set: 0 });
        let plan = plan(&mesh, &uniform(0)).expect("fits");
        let tables = passes::tables::build(&plan, &mesh, &[Some(detail)]).expect("tables");
        Self { mesh, tables, tolerance }
    }

    fn compare(&self, name: &str, device: &Arc<Device>) {
        let cancel = Cancel::default();
        let marks = Marks::default();
        let start = Instant::now();
        let job = JobContext { cancel: &cancel, progress: &marks };
        let made = tessellate::tessellate(&job, &self.plan(), &self.tables, &self.mesh).expect("runs");
        let whole = start.elapsed().as_secs_f64() * 1e3;
        let refined = marks.refined_ms(start);
        println!(
            "{name:<8} host   {:7} triangles  refine {refined:8.0} ms  all {whole:8.0} ms",
            made.mesh.triangles.len()
        );
        for _ in 0..2 {
            let start = Instant::now();
            let job = JobContext { cancel: &cancel, progress: &NoProgress };
            let made = device::tessellate(device, &job, &self.plan(), &self.tables, &self.mesh).expect("runs");
            println!(
                "{name} device {} {:?} {}",
                made.mesh.triangles.len(),
                made.times,
                start.elapsed().as_secs_f64() * 1e3
            );
        }
    }

    fn plan(&self) -> TolerancePlan {
        TolerancePlan {
            tolerance_local: self.tolerance,
            unit_per_local: 1.0,
            views: Vec::new(),
            error_at: ErrorAt::Surface,
            quality: Quality::Normal,
            max_triangles: 1 << 24,
        }
    }
}

/// When collapses began.
#[derive(Default)]
struct Marks(Mutex<Option<Instant>>);

impl Marks {
    fn refined_ms(&self, start: Instant) -> f64 {
        self.0.lock().unwrap().map_or(0.0, |at| at.duration_since(start).as_secs_f64() * 1e3)
    }
}

impl Progress for Marks {
    fn pass(&self, name: &str, _: u64, _: u64) {
        if name == "collapse" {
            self.0.lock().unwrap().get_or_insert_with(Instant::now);
        }
    }
}

fn map(path: &Path) -> Map {
    use exr::prelude::*;
    let image = read_first_flat_layer_from_file(path).expect("a height field");
    let Vec2(width, height) = image.layer_data.size;
    let texels: Vec<f32> = image.layer_data.channel_data.list[0].sample_data.values_as_f32().collect();
    displace_server::domain::detail::Map {
        width: width as u32,
        height: height as u32,
        channels: 1,
        texels,
        wrap: [Wrap::Clamp; 2],
        sampling: Sampling::Node,
        source_bits: 32,
    }
}
