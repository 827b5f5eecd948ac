//! What a device must be able to do, and the names of what it lacks.

use ash::{ext::robustness2, vk};

use super::instance::Instance;

/// Storage buffers one shader may bind: eight paged streams.
const MIN_STORAGE_BUFFERS: u32 = 8 * 16;
/// No binding is ever larger; the least every implementation must allow.
pub(crate) const MAX_BINDING_BYTES: u64 = 128 << 20;
/// The least every implementation must allow.
pub(crate) const MAX_PUSH_CONSTANT_BYTES: u32 = 128;

/// The names of required features and limits the device lacks; empty if it can be used.
pub(crate) fn missing(instance: &Instance, physical: vk::PhysicalDevice) -> Vec<&'static str> {
    // SAFETY: `physical` belongs to `instance`, here and below.
    let properties = unsafe { instance.handle.get_physical_device_properties(physical) };
    if properties.api_version < vk::API_VERSION_1_3 {
        return vec!["Vulkan 1.3"];
    }
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut v13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut v12).push_next(&mut v13);
    // SAFETY: as above; the chain holds each struct once.
    unsafe { instance.handle.get_physical_device_features2(physical, &mut all) };
    let core = all.features;
    let limits = properties.limits;
    let needs = [
        ("robustBufferAccess", core.robust_buffer_access == vk::TRUE),
        ("shaderInt64", core.shader_int64 == vk::TRUE),
        ("shaderStorageBufferArrayDynamicIndexing", core.shader_storage_buffer_array_dynamic_indexing == vk::TRUE),
        (
            "shaderStorageBufferArrayNonUniformIndexing",
            v12.shader_storage_buffer_array_non_uniform_indexing == vk::TRUE,
        ),
        ("scalarBlockLayout", v12.scalar_block_layout == vk::TRUE),
        ("timelineSemaphore", v12.timeline_semaphore == vk::TRUE),
        ("synchronization2", v13.synchronization2 == vk::TRUE),
        ("maintenance4", v13.maintenance4 == vk::TRUE),
        ("128 storage buffers per stage", limits.max_per_stage_descriptor_storage_buffers >= MIN_STORAGE_BUFFERS),
        ("a compute queue with timestamps", queue_family(instance, physical).is_some()),
    ];
    needs.into_iter().filter(|(_, present)| !present).map(|(name, _)| name).collect()
}

/// Whether its shaders may have 64-bit atomics; without them keys of the visibility buffer are written by halves.
pub(crate) fn has_int64_atomics(instance: &Instance, physical: vk::PhysicalDevice) -> bool {
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut v12);
    // SAFETY: `physical` belongs to `instance`; the chain holds each struct once.
    unsafe { instance.handle.get_physical_device_features2(physical, &mut all) };
    v12.shader_buffer_int64_atomics == vk::TRUE
}

/// A family that computes and measures time; one without graphics if there is a choice.
pub(crate) fn queue_family(instance: &Instance, physical: vk::PhysicalDevice) -> Option<(u32, u32)> {
    // SAFETY: `physical` belongs to `instance`.
    let families = unsafe { instance.handle.get_physical_device_queue_family_properties(physical) };
    let usable = families
        .iter()
        .enumerate()
        .filter(|(_, family)| family.queue_flags.contains(vk::QueueFlags::COMPUTE) && family.timestamp_valid_bits > 0);
    let best = usable.min_by_key(|(_, family)| family.queue_flags.contains(vk::QueueFlags::GRAPHICS));
    best.map(|(index, family)| (index as u32, family.timestamp_valid_bits))
}

/// Creates the logical device with exactly the features above, robustness2 where there is one, and 64-bit atomics if told so.
pub(crate) fn create_device(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    family: u32,
    int64_atomics: bool,
) -> Result<ash::Device, vk::Result> {
    let priorities = [1.0];
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&priorities)];
    let core = vk::PhysicalDeviceFeatures::default()
        .robust_buffer_access(true)
        .shader_int64(true)
        .shader_storage_buffer_array_dynamic_indexing(true);
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default()
        .shader_storage_buffer_array_non_uniform_indexing(true)
        .scalar_block_layout(true)
        .timeline_semaphore(true)
        .shader_buffer_int64_atomics(int64_atomics);
    let mut v13 = vk::PhysicalDeviceVulkan13Features::default().synchronization2(true).maintenance4(true);
    let mut robust = vk::PhysicalDeviceRobustness2FeaturesEXT::default().robust_buffer_access2(true);
    let extensions = [robustness2::NAME.as_ptr()];
    let mut info = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_features(&core)
        .push_next(&mut v12)
        .push_next(&mut v13);
    if has_robustness2(instance, physical) {
        info = info.enabled_extension_names(&extensions).push_next(&mut robust);
    }
    // SAFETY: `physical` belongs to `instance`, and `info` lives to the end of the call.
    unsafe { instance.handle.create_device(physical, &info, None) }
}

fn has_robustness2(instance: &Instance, physical: vk::PhysicalDevice) -> bool {
    // SAFETY: `physical` belongs to `instance`, here and below.
    let extensions = unsafe { instance.handle.enumerate_device_extension_properties(physical) }.unwrap_or_default();
    if !extensions.iter().any(|extension| extension.extension_name_as_c_str() == Ok(robustness2::NAME)) {
        return false;
    }
    let mut robust = vk::PhysicalDeviceRobustness2FeaturesEXT::default();
    let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut robust);
    // SAFETY: as above.
    unsafe { instance.handle.get_physical_device_features2(physical, &mut all) };
    robust.robust_buffer_access2 == vk::TRUE
}
