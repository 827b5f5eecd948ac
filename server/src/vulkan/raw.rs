//! The logical device and its one queue, and the wrappers that own one handle each.

use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicBool, Ordering},
};

use ash::{ext::debug_utils, vk};

use super::{
    error::{Error, ErrorKind, Result, failed},
    features,
    instance::Instance,
    select::Candidate,
};

/// A submission that takes longer than this hangs. Submissions are cut to well under a second of
/// computing, but the first one of a shader may wait for a slow machine to compile it.
const HANG_TIMEOUT_NS: u64 = 120_000_000_000;

pub(crate) struct Raw {
    pub(crate) device: ash::Device,
    pub(crate) instance: Arc<Instance>,
    pub(crate) physical: vk::PhysicalDevice,
    pub(crate) limits: vk::PhysicalDeviceLimits,
    pub(crate) family: u32,
    /// Bits of a timestamp that count.
    timestamp_mask: u64,
    queue: Mutex<vk::Queue>,
    /// Set when work was given up on that may still run: then nothing it might touch is ever destroyed.
    abandoned: AtomicBool,
    names: Option<debug_utils::Device>,
}

impl Raw {
    pub(crate) fn new(instance: &Arc<Instance>, candidate: &Candidate, int64_atomics: bool) -> Result<Arc<Self>> {
        let physical = candidate.physical;
        let Some((family, timestamp_bits)) = features::queue_family(instance, physical) else {
            return Err(Error::unsupported(format!("{} has no compute queue with timestamps", candidate.info)));
        };
        let device = features::create_device(instance, physical, family, int64_atomics)
            .map_err(failed("creating the device"))?;
        // SAFETY: one queue of this family was asked for; `physical` belongs to `instance`.
        let (queue, properties) =
            unsafe { (device.get_device_queue(family, 0), instance.handle.get_physical_device_properties(physical)) };
        let names = instance.validates().then(|| debug_utils::Device::new(&instance.handle, &device));
        Ok(Arc::new(Self {
            device,
            instance: instance.clone(),
            physical,
            limits: properties.limits,
            family,
            timestamp_mask: u64::MAX >> (64 - timestamp_bits.clamp(1, 64)),
            queue: Mutex::new(queue),
            abandoned: AtomicBool::new(false),
            names,
        }))
    }

    /// Gives a handle a name for people who read validation messages and captures.
    pub(crate) fn name<H: vk::Handle>(&self, handle: H, name: &str) {
        let Some(names) = &self.names else { return };
        let terminated = std::ffi::CString::new(name.replace('\0', "?")).unwrap_or_default();
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&terminated);
        // SAFETY: the handle was made by this device and lives. A name that does not stick harms nothing.
        let _ = unsafe { names.set_debug_utils_object_name(&info) };
    }

    /// Starts a labelled region of a command buffer, for the same people.
    pub(crate) fn label(&self, command: vk::CommandBuffer, name: &str) {
        let Some(names) = &self.names else { return };
        let terminated = std::ffi::CString::new(name.replace('\0', "?")).unwrap_or_default();
        let info = vk::DebugUtilsLabelEXT::default().label_name(&terminated);
        // SAFETY: the caller records `command`, which belongs to this device.
        unsafe { names.cmd_insert_debug_utils_label(command, &info) };
    }

    pub(crate) fn nanoseconds(&self, begin: u64, end: u64) -> f64 {
        let ticks = end.wrapping_sub(begin) & self.timestamp_mask;
        ticks as f64 * f64::from(self.limits.timestamp_period)
    }

    pub(crate) fn is_abandoned(&self) -> bool {
        self.abandoned.load(Ordering::Acquire)
    }

    /// Fails once a submission was given up on.
    pub(crate) fn check_alive(&self) -> Result<()> {
        if !self.is_abandoned() {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Lost, "the device stopped answering and was given up: open it anew"))
    }

    /// Fails on what the validation layers found in anything done so far.
    pub(crate) fn check_messages(&self) -> Result<()> {
        match &self.instance.messages {
            Some(messages) if messages.count() > 0 => {
                Err(Error::internal(format!("Vulkan validation: {}", messages.texts().join("; "))))
            }
            _ => Ok(()),
        }
    }

    /// Submits one recorded command buffer and waits for its end.
    pub(crate) fn submit_and_wait(&self, command: vk::CommandBuffer, timeline: &Timeline) -> Result<()> {
        self.check_alive()?;
        let value = self.submit(command, timeline)?;
        let semaphores = [timeline.semaphore.handle];
        let values = [value];
        let wait = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        // SAFETY: the semaphore is alive and belongs to this device.
        let waited = unsafe { self.device.wait_semaphores(&wait, HANG_TIMEOUT_NS) };
        if waited.is_err() {
            self.abandoned.store(true, Ordering::Release);
        }
        waited.map_err(|result| match result {
            vk::Result::TIMEOUT => {
                Error::new(ErrorKind::Lost, "the device did not finish a short piece of work in 120 s")
            }
            other => failed("waiting for the device")(other),
        })?;
        self.check_messages()
    }

    fn submit(&self, command: vk::CommandBuffer, timeline: &Timeline) -> Result<u64> {
        let queue = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        let mut last = timeline.last.lock().unwrap_or_else(PoisonError::into_inner);
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(command)];
        let signals = [vk::SemaphoreSubmitInfo::default()
            .semaphore(timeline.semaphore.handle)
            .value(*last + 1)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)];
        let submits = [vk::SubmitInfo2::default().command_buffer_infos(&commands).signal_semaphore_infos(&signals)];
        // SAFETY: the queue is locked; `command` is recorded, and its batch keeps all it uses until it has ended.
        unsafe { self.device.queue_submit2(*queue, &submits, vk::Fence::null()) }.map_err(failed("submitting work"))?;
        *last += 1;
        Ok(*last)
    }
}

impl Drop for Raw {
    fn drop(&mut self) {
        if self.is_abandoned() {
            // The driver may still run what was abandoned: the instance must outlive it as well.
            std::mem::forget(self.instance.clone());
            return;
        }
        // SAFETY: every wrapper keeps this alive, so all are gone, and all submissions were waited for.
        unsafe { self.device.destroy_device(None) };
    }
}

/// Wrappers that own one handle and destroy it when dropped, unless abandoned work may still use it.
macro_rules! owned {
    ($($name:ident: $handle:ty, $destroy:ident;)*) => {$(
        pub(crate) struct $name {
            pub(crate) handle: $handle,
            raw: Arc<Raw>,
        }

        impl $name {
            /// Takes ownership of a handle just made by the device of `raw`.
            pub(crate) fn new(raw: &Arc<Raw>, handle: $handle) -> Self {
                Self { handle, raw: raw.clone() }
            }
        }

        impl Drop for $name {
            fn drop(&mut self) {
                if !self.raw.is_abandoned() {
                    // SAFETY: made by this device and owned by `self` alone; a batch in flight would own a
                    // clone of whatever holds it, and every submission is waited for.
                    unsafe { self.raw.device.$destroy(self.handle, None) };
                }
            }
        }
    )*};
}

owned! {
    BufferHandle: vk::Buffer, destroy_buffer;
    CommandPool: vk::CommandPool, destroy_command_pool;
    DescriptorPool: vk::DescriptorPool, destroy_descriptor_pool;
    DescriptorSetLayout: vk::DescriptorSetLayout, destroy_descriptor_set_layout;
    PipelineCacheHandle: vk::PipelineCache, destroy_pipeline_cache;
    PipelineHandle: vk::Pipeline, destroy_pipeline;
    PipelineLayout: vk::PipelineLayout, destroy_pipeline_layout;
    QueryPool: vk::QueryPool, destroy_query_pool;
    Semaphore: vk::Semaphore, destroy_semaphore;
    ShaderModule: vk::ShaderModule, destroy_shader_module;
}

/// Counts submissions: the semaphore reaches n when the n-th has ended.
pub(crate) struct Timeline {
    semaphore: Semaphore,
    last: Mutex<u64>,
}

impl Timeline {
    pub(crate) fn new(raw: &Arc<Raw>) -> Result<Self> {
        let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        // SAFETY: timelineSemaphore is a required feature and enabled.
        let handle = unsafe { raw.device.create_semaphore(&info, None) }.map_err(failed("creating the timeline"))?;
        raw.name(handle, "timeline");
        Ok(Self { semaphore: Semaphore::new(raw, handle), last: Mutex::new(0) })
    }
}
