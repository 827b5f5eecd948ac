//! The executor on a Vulkan device.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use displace_glsl::ALL_SHADERS;

use super::{Executor, ExecutorOptions, JobContext, image, image::KeptCones, passes, tessellate};
use crate::{
    domain::{
        Result,
        cost::CostModel,
        detail::Detail,
        image::{ImagePlan, ImageSet, RenderScene},
        mesh::Mesh,
        plan::SurfacePlan,
        report::PassTime,
        surface::{Shape, Surface},
    },
    vulkan::{Device, DeviceOptions, cache_file},
};

/// One open device.
pub struct VulkanExecutor {
    device: Arc<Device>,
    cones: KeptCones,
    name: String,
    driver: String,
    class: String,
    costs: OnceLock<CostModel>,
    /// Where they are kept.
    costs_file: Option<PathBuf>,
}

impl VulkanExecutor {
    pub fn open(options: &ExecutorOptions) -> Result<Self> {
        let device = Device::open(&DeviceOptions {
            selector: options.device.clone(),
            validation: options.validation,
            cache_dir: Some(options.cache.clone()),
            budget_bytes: options.device_bytes,
            ..DeviceOptions::default()
        })?;
        if options.warm_up {
            let kind = device.info().kind;
            let runs = |name: &str| !name.starts_with("selftest_") && tessellate::device::runs(kind, name);
            let passes: Vec<_> = ALL_SHADERS.iter().copied().filter(|shader| runs(shader.name)).collect();
            device.warm_up(&passes)?;
        }
        let mut executor = Self::with_device(device);
        executor.keep_costs_in(&options.cache);
        Ok(executor)
    }

    /// Constants of another build may be of other passes.
    fn keep_costs_in(&mut self, folder: &Path) {
        let depends_on = [self.class.as_bytes(), self.driver.as_bytes(), env!("CARGO_PKG_VERSION").as_bytes()];
        let file = cache_file::path(folder, "costs", &depends_on);
        if let Ok(known) = serde_json::from_slice::<CostModel>(&cache_file::read(&file))
            && known.is_sound()
        {
            self.costs = OnceLock::from(known);
        }
        self.costs_file = Some(file);
    }

    #[must_use]
    pub fn with_device(device: Arc<Device>) -> Self {
        let info = device.info();
        let name = info.name.clone();
        let driver = info.driver.clone();
        let class = info.class();
        let cones = KeptCones::default();
        Self { device, cones, name, driver, class, costs: OnceLock::new(), costs_file: None }
    }

    /// The device, for tests and measurements.
    #[must_use]
    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }
}

impl Executor for VulkanExecutor {
    fn device_name(&self) -> &str {
        &self.name
    }

    fn driver(&self) -> &str {
        &self.driver
    }

    fn device_class(&self) -> &str {
        &self.class
    }

    fn costs(&self) -> Option<CostModel> {
        self.costs.get().copied()
    }

    fn keep_costs(&self, measured: CostModel) {
        let first = self.costs.set(measured).is_ok();
        if let (true, Some(file), Ok(bytes)) = (first, &self.costs_file, serde_json::to_vec(&measured)) {
            cache_file::write(file, &bytes);
        }
    }

    fn displace(
        &self,
        job: &JobContext<'_>,
        plan: &SurfacePlan,
        mesh: &Mesh,
        detail_of_primitive: &[Option<Arc<Detail>>],
    ) -> Result<(Surface, Vec<PassTime>)> {
        passes::displace(&self.device, job, plan, mesh, detail_of_primitive)
    }

    fn finish(
        &self,
        job: &JobContext<'_>,
        plan: &SurfacePlan,
        mesh: &Mesh,
        detail_of_primitive: &[Option<Arc<Detail>>],
        shape: Shape,
    ) -> Result<(Surface, Vec<PassTime>)> {
        passes::finish(&self.device, job, plan, mesh, detail_of_primitive, shape)
    }

    fn render(&self, job: &JobContext<'_>, plan: &ImagePlan, scene: &RenderScene) -> Result<(ImageSet, Vec<PassTime>)> {
        image::render(&self.device, job, plan, scene, &self.cones)
    }
}
