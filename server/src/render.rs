//! Executors of a plan: the Vulkan device and the f64 reference.

pub mod image;
pub mod lists;
mod occluders;
pub mod passes;
pub mod reference;
pub mod reference_image;
pub mod refine;
mod reflection;
mod shadow_map;
pub mod tessellate;
pub mod vulkan;

use std::sync::Arc;

use crate::domain::{
    Error, ErrorKind, Result,
    cancel::{Cancel, Progress},
    cost::CostModel,
    detail::Detail,
    image::{ImagePlan, ImageSet, RenderScene},
    mesh::Mesh,
    plan::{MAX_PAGES, MAX_TEXELS, PAGE_ELEMENTS, SurfacePlan},
    report::PassTime,
    surface::{Shape, Surface},
};
use crate::vulkan as device;

/// Which device, and how.
#[derive(Clone, Debug, Default)]
pub struct ExecutorOptions {
    /// Name, index or UUID; `reference`; none for the best.
    pub device: Option<String>,
    pub validation: bool,
    /// Folder of compiled pipelines.
    pub cache: std::path::PathBuf,
    /// Device memory of one job.
    pub device_bytes: u64,
    /// Has every pass compiled before the device is called open, so that no job waits for it.
    pub warm_up: bool,
}

/// Opens the device that `options` name.
pub fn open(options: &ExecutorOptions) -> Result<Box<dyn Executor>> {
    if options.device.as_deref() == Some("reference") {
        return Ok(Box::new(reference::ReferenceExecutor));
    }
    Ok(Box::new(vulkan::VulkanExecutor::open(options)?))
}

/// What an executor needs to know of the job beyond its plan.
pub struct JobContext<'a> {
    pub cancel: &'a Cancel,
    pub progress: &'a dyn Progress,
}

/// Runs plans. Two implementations: `vulkan::VulkanExecutor` and `reference::ReferenceExecutor`.
pub trait Executor: Send + Sync {
    /// Name for people, such as `llvmpipe (LLVM 15.0.6, 256 bits)` or `reference`.
    fn device_name(&self) -> &str;

    /// Driver name and version; empty for `reference`.
    fn driver(&self) -> &str {
        ""
    }

    /// Part of every result key: results of different classes may differ in the last bits.
    fn device_class(&self) -> &str;

    /// What the device was measured to take, where that is known; see `jobs::calibration`.
    fn costs(&self) -> Option<CostModel> {
        Some(CostModel::default())
    }

    /// Keeps what was measured, for this run and those to come.
    fn keep_costs(&self, _measured: CostModel) {}

    /// Displaces one base mesh. `detail_of_primitive[p]` is the detail of primitive p, if it has one.
    fn displace(
        &self,
        job: &JobContext<'_>,
        plan: &SurfacePlan,
        mesh: &Mesh,
        detail_of_primitive: &[Option<Arc<Detail>>],
    ) -> Result<(Surface, Vec<PassTime>)>;

    /// Gives a shape of a base mesh its normals and attributes. Levels of the plan do not matter.
    fn finish(
        &self,
        job: &JobContext<'_>,
        plan: &SurfacePlan,
        mesh: &Mesh,
        detail_of_primitive: &[Option<Arc<Detail>>],
        shape: Shape,
    ) -> Result<(Surface, Vec<PassTime>)>;

    /// Whether `render` takes plans with rays.
    fn traces_rays(&self) -> bool {
        false
    }

    /// Renders an image of displaced (or plain) meshes.
    fn render(&self, job: &JobContext<'_>, plan: &ImagePlan, scene: &RenderScene) -> Result<(ImageSet, Vec<PassTime>)>;
}

impl From<device::Error> for Error {
    fn from(error: device::Error) -> Self {
        let message = error.message.clone();
        match error.kind {
            device::ErrorKind::OutOfMemory => Self::too_large("device", message),
            device::ErrorKind::NotSupported => Self::unsupported("device", message),
            device::ErrorKind::Cancelled => Self::cancelled(),
            device::ErrorKind::Lost => Self::new(ErrorKind::Unavailable, message).with_cause(error),
            device::ErrorKind::Internal => Self::internal(message).with_cause(error),
        }
    }
}

impl From<device::PassTime> for PassTime {
    fn from(time: device::PassTime) -> Self {
        Self { name: time.name.into(), ms: time.ms, bytes: time.bytes }
    }
}

impl device::CancelSignal for Cancel {
    fn is_cancelled(&self) -> bool {
        Self::is_cancelled(self)
    }
}

impl<P: Progress + ?Sized> device::PassObserver for P {
    fn pass(&self, name: &str, done: u64, total: u64) {
        Progress::pass(self, name, done, total);
    }
}

// The device pages streams as plans assume.
const _: () = assert!(PAGE_ELEMENTS == 1 << device::PAGE_SHIFT && MAX_PAGES == device::MAX_PAGES);
const _: () = assert!(MAX_TEXELS == MAX_PAGES << (device::PAGE_SHIFT + device::TEXELS_MORE_SHIFT));
