//! The executor on a Vulkan device.

use std::sync::Arc;

use displace_glsl::ALL_SHADERS;

use super::{Executor, ExecutorOptions, JobContext, image, image::KeptCones, passes, tessellate};
use crate::{
    domain::{
        Result,
        detail::Detail,
        image::{ImagePlan, ImageSet, RenderScene},
        mesh::Mesh,
        plan::SurfacePlan,
        report::PassTime,
        surface::{Shape, Surface},
    },
    vulkan::{Device, DeviceOptions},
};

/// One open device.
pub struct VulkanExecutor {
    device: Arc<Device>,
    cones: KeptCones,
    name: String,
    driver: String,
    class: String,
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
        Ok(Self::with_device(device))
    }

    #[must_use]
    pub fn with_device(device: Arc<Device>) -> Self {
        let info = device.info();
        let name = info.name.clone();
        let driver = info.driver.clone();
        let class = info.class();
        Self { device, cones: KeptCones::default(), name, driver, class }
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
