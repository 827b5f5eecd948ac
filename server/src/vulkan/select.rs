//! The devices of this machine, and which of them to use: discrete GPUs first, processors last.

use std::{ffi::CStr, fmt};

use ash::vk;

use super::{
    error::{Error, Result, failed},
    features,
    instance::Instance,
};

/// In order of preference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeviceKind {
    Discrete,
    Integrated,
    Virtual,
    Other,
    Cpu,
}

/// A device as people and keys name it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Position in `list_devices`, usable as a selector.
    pub index: usize,
    pub name: String,
    /// 32 hexadecimal digits, usable as a selector.
    pub uuid: String,
    pub kind: DeviceKind,
    /// Driver and its version, such as `llvmpipe Mesa 25.0.7 (LLVM 15.0.6)`.
    pub driver: String,
    pub api_version: String,
    /// The largest heap local to the device.
    pub memory_bytes: u64,
    /// Names of required features it lacks; a device that lacks one cannot be opened.
    pub missing: Vec<&'static str>,
}

impl DeviceInfo {
    /// Part of result keys: equal classes give equal bits.
    #[must_use]
    pub fn class(&self) -> String {
        format!("{}; {}", self.name, self.driver)
    }
}

impl fmt::Display for DeviceInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} ({})", self.index, self.name, self.driver)
    }
}

pub(crate) struct Candidate {
    pub(crate) physical: vk::PhysicalDevice,
    pub(crate) info: DeviceInfo,
    /// Everything that may change how the driver compiles, for the names of cache files.
    pub(crate) identity: String,
}

/// All Vulkan devices of this machine, the preferred one first, also those that cannot be used.
pub fn list_devices() -> Result<Vec<DeviceInfo>> {
    Ok(candidates(&*Instance::new(false)?)?.into_iter().map(|candidate| candidate.info).collect())
}

/// The devices a selector stands for, in the order in which to try them.
pub(crate) fn select(instance: &Instance, selector: Option<&str>) -> Result<Vec<Candidate>> {
    let mut all = candidates(instance)?;
    if all.is_empty() {
        return Err(Error::unsupported("this machine has no Vulkan device: install mesa-vulkan-drivers 25 or later"));
    }
    let Some(selector) = selector else { return Ok(all) };
    let infos: Vec<_> = all.iter().map(|candidate| candidate.info.clone()).collect();
    match position(&infos, selector) {
        Some(index) => Ok(vec![all.swap_remove(index)]),
        None => {
            let names: Vec<_> = infos.iter().map(ToString::to_string).collect();
            Err(Error::unsupported(format!("no device matches '{selector}'; there are {}", names.join(", "))))
        }
    }
}

/// UUID, index, or part of the name, in this order.
fn position(infos: &[DeviceInfo], selector: &str) -> Option<usize> {
    let uuid = selector.replace('-', "").to_lowercase();
    if let Some(found) = infos.iter().position(|info| info.uuid == uuid) {
        return Some(found);
    }
    if let Ok(index) = selector.parse::<usize>() {
        return (index < infos.len()).then_some(index);
    }
    let part = selector.to_lowercase();
    infos.iter().position(|info| !part.is_empty() && info.name.to_lowercase().contains(&part))
}

fn candidates(instance: &Instance) -> Result<Vec<Candidate>> {
    // SAFETY: the instance is alive.
    let physical = unsafe { instance.handle.enumerate_physical_devices() }.map_err(failed("listing devices"))?;
    let mut all: Vec<_> = physical.into_iter().map(|physical| describe(instance, physical)).collect();
    all.sort_by_key(|candidate| candidate.info.kind);
    for (index, candidate) in all.iter_mut().enumerate() {
        candidate.info.index = index;
    }
    Ok(all)
}

fn describe(instance: &Instance, physical: vk::PhysicalDevice) -> Candidate {
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut id = vk::PhysicalDeviceIDProperties::default();
    let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut driver).push_next(&mut id);
    // SAFETY: `physical` belongs to `instance`; the chain holds each struct once.
    unsafe { instance.handle.get_physical_device_properties2(physical, &mut all) };
    let properties = all.properties;
    let version = properties.api_version;
    let info = DeviceInfo {
        index: 0,
        name: text(properties.device_name_as_c_str()),
        uuid: hex(&id.device_uuid),
        kind: kind(properties.device_type),
        driver: format!("{} {}", text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str())),
        api_version: format!(
            "{}.{}.{}",
            vk::api_version_major(version),
            vk::api_version_minor(version),
            vk::api_version_patch(version)
        ),
        memory_bytes: memory_bytes(instance, physical),
        missing: features::missing(instance, physical),
    };
    let identity = format!(
        "{} {} {} {} {} {}",
        info.class(),
        info.uuid,
        hex(&id.driver_uuid),
        properties.driver_version,
        info.api_version,
        hex(&properties.pipeline_cache_uuid)
    );
    Candidate { physical, info, identity }
}

fn memory_bytes(instance: &Instance, physical: vk::PhysicalDevice) -> u64 {
    // SAFETY: `physical` belongs to `instance`.
    let memory = unsafe { instance.handle.get_physical_device_memory_properties(physical) };
    let local =
        memory.memory_heaps_as_slice().iter().filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
    local.map(|heap| heap.size).max().unwrap_or(0)
}

fn kind(device_type: vk::PhysicalDeviceType) -> DeviceKind {
    match device_type {
        vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::Discrete,
        vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::Integrated,
        vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::Virtual,
        vk::PhysicalDeviceType::CPU => DeviceKind::Cpu,
        _ => DeviceKind::Other,
    }
}

fn text(name: Result<&CStr, std::ffi::FromBytesUntilNulError>) -> String {
    name.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(index: usize, name: &str, uuid: &str) -> DeviceInfo {
        DeviceInfo {
            index,
            name: name.into(),
            uuid: uuid.into(),
            kind: DeviceKind::Other,
            driver: String::new(),
            api_version: String::new(),
            memory_bytes: 0,
            missing: Vec::new(),
        }
    }

    #[test]
    fn a_selector_is_a_uuid_or_an_index_or_part_of_a_name() {
        let infos = [
            info(0, "NVIDIA L40S", "00000000000000000000000000000001"),
            info(1, "llvmpipe (LLVM 15.0.6, 256 bits)", "6d657361323500000000000000000000"),
        ];
        for (selector, expected) in [
            ("6D657361-3235-0000-0000-000000000000", Some(1)),
            ("00000000000000000000000000000001", Some(0)),
            ("1", Some(1)),
            ("2", None),
            ("LLVMpipe", Some(1)),
            ("l40s", Some(0)),
            ("radeon", None),
            ("", None),
        ] {
            assert_eq!(position(&infos, selector), expected, "selector '{selector}'");
        }
    }

    #[test]
    fn discrete_devices_come_first_and_processors_last() {
        let mut kinds = [DeviceKind::Cpu, DeviceKind::Virtual, DeviceKind::Discrete, DeviceKind::Integrated];
        kinds.sort();
        assert_eq!(kinds, [DeviceKind::Discrete, DeviceKind::Integrated, DeviceKind::Virtual, DeviceKind::Cpu]);
    }
}
