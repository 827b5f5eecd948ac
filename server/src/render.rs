//! Executors of a plan: the Vulkan device and the f64 reference.

use std::sync::Arc;

use crate::domain::{
    Result,
    cancel::{Cancel, Progress},
    detail::Detail,
    image::{ImagePlan, ImageSet, RenderScene},
    mesh::Mesh,
    plan::SurfacePlan,
    report::PassTime,
    surface::Surface,
};

/// What an executor needs to know of the job beyond its plan.
pub struct JobContext<'a> {
    pub cancel: &'a Cancel,
    pub progress: &'a dyn Progress,
}

/// Runs plans. Two implementations: `vulkan::VulkanExecutor` and `reference::ReferenceExecutor`.
pub trait Executor: Send + Sync {
    /// Name for people, such as `llvmpipe (LLVM 15.0.6, 256 bits)` or `reference`.
    fn device_name(&self) -> &str;

    /// Part of every result key: results of different classes may differ in the last bits.
    fn device_class(&self) -> &str;

    /// Displaces one base mesh. `detail_of_primitive[p]` is the detail of primitive p, if it has one.
    fn displace(
        &self,
        job: &JobContext<'_>,
        plan: &SurfacePlan,
        mesh: &Mesh,
        detail_of_primitive: &[Option<Arc<Detail>>],
    ) -> Result<(Surface, Vec<PassTime>)>;

    /// Renders an image of displaced (or plain) meshes.
    fn render(&self, job: &JobContext<'_>, plan: &ImagePlan, scene: &RenderScene) -> Result<(ImageSet, Vec<PassTime>)>;
}
