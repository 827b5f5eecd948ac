//! Device memory: one allocator and one budget per device, and buffers that own their share of both.

use std::{
    fmt,
    ptr::NonNull,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

use ash::vk;
use gpu_allocator::{
    AllocationError, AllocationSizes, AllocatorDebugSettings, MemoryLocation,
    vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc},
};

use super::{
    access::Access,
    error::{Error, ErrorKind, Result, failed},
    raw::{BufferHandle, Raw},
};

/// Blocks the allocator asks the driver for. The largest page fits, so pages are taken from blocks and
/// the last block is kept for the next job.
const BLOCK_BYTES: u64 = 256 << 20;

/// Bytes in use and the most that may be.
#[derive(Debug)]
pub(crate) struct Budget {
    limit_bytes: u64,
    used_bytes: AtomicU64,
}

impl Budget {
    pub(crate) fn new(limit_bytes: u64) -> Arc<Self> {
        Arc::new(Self { limit_bytes, used_bytes: AtomicU64::new(0) })
    }

    pub(crate) fn used_bytes(&self) -> u64 {
        self.used_bytes.load(Ordering::Relaxed)
    }

    fn charge(self: &Arc<Self>, bytes: u64, name: &str) -> Result<Charge> {
        let taken = self.used_bytes.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |used| {
            used.checked_add(bytes).filter(|total| *total <= self.limit_bytes)
        });
        match taken {
            Ok(_) => Ok(Charge { budget: self.clone(), bytes }),
            Err(used) => Err(out_of_memory(name, bytes, self.limit_bytes.saturating_sub(used))),
        }
    }
}

/// Part of a budget, given back when dropped.
#[derive(Debug)]
struct Charge {
    budget: Arc<Budget>,
    bytes: u64,
}

impl Drop for Charge {
    fn drop(&mut self) {
        self.budget.used_bytes.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

fn out_of_memory(name: &str, needed: u64, available: u64) -> Error {
    Error::new(
        ErrorKind::OutOfMemory,
        format!(
            "'{name}' needs {needed} bytes of device memory, {available} are available: ask for less detail or a smaller image, or raise the device memory budget"
        ),
    )
}

/// Where a buffer lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Read and written by shaders; mapped if the device's memory is the host's.
    Device,
    /// Mapped, for copies to and from the device.
    Staging,
}

pub(crate) struct Memory {
    /// Dropped, and its blocks with it, before the device.
    allocator: Mutex<Allocator>,
    pub(crate) budget: Arc<Budget>,
    /// Device memory is cached host memory: streams are mapped and nothing is staged.
    pub(crate) direct: bool,
    pub(crate) raw: Arc<Raw>,
}

impl Memory {
    pub(crate) fn new(raw: &Arc<Raw>, budget_bytes: u64, force_staging: bool) -> Result<Arc<Self>> {
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: raw.instance.handle.clone(),
            device: raw.device.clone(),
            physical_device: raw.physical,
            debug_settings: AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: AllocationSizes::new(BLOCK_BYTES, BLOCK_BYTES),
        })
        .map_err(|cause| Error::internal("the memory allocator could not start").with_cause(cause))?;
        let direct = !force_staging && is_unified(raw);
        Ok(Arc::new(Self {
            allocator: Mutex::new(allocator),
            budget: Budget::new(budget_bytes),
            direct,
            raw: raw.clone(),
        }))
    }

    fn allocate(self: &Arc<Self>, name: &str, place: Place, requirements: vk::MemoryRequirements) -> Result<Allocated> {
        let location =
            if place == Place::Staging || self.direct { MemoryLocation::GpuToCpu } else { MemoryLocation::GpuOnly };
        let description = AllocationCreateDesc {
            name,
            requirements,
            location,
            linear: true,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        };
        let mut allocator = self.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        match allocator.allocate(&description) {
            Ok(allocation) => Ok(Allocated { allocation, memory: self.clone() }),
            Err(AllocationError::OutOfMemory) => Err(out_of_memory(name, requirements.size, 0)),
            Err(cause) => Err(Error::internal(format!("no memory for '{name}'")).with_cause(cause)),
        }
    }
}

/// True where all that the device calls local is also cached memory of the host: software devices and
/// integrated ones. A discrete device that maps its memory uncached is slower to read than to stage.
fn is_unified(raw: &Raw) -> bool {
    // SAFETY: the physical device belongs to the instance.
    let memory = unsafe { raw.instance.handle.get_physical_device_memory_properties(raw.physical) };
    let wanted = vk::MemoryPropertyFlags::DEVICE_LOCAL
        | vk::MemoryPropertyFlags::HOST_VISIBLE
        | vk::MemoryPropertyFlags::HOST_COHERENT
        | vk::MemoryPropertyFlags::HOST_CACHED;
    memory.memory_types_as_slice().iter().any(|kind| kind.property_flags.contains(wanted))
}

/// A share of the allocator's memory, given back when dropped.
struct Allocated {
    allocation: Allocation,
    memory: Arc<Memory>,
}

impl Drop for Allocated {
    fn drop(&mut self) {
        if self.memory.raw.is_abandoned() {
            return;
        }
        let mut allocator = self.memory.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        if let Err(error) = allocator.free(std::mem::take(&mut self.allocation)) {
            tracing::error!(%error, "device memory could not be given back");
        }
    }
}

/// One buffer with its memory. Fields drop in order: the handle before the memory it is bound to.
pub(crate) struct Buffer {
    handle: BufferHandle,
    allocated: Allocated,
    _charge: Charge,
    pub(crate) bytes: u64,
    pub(crate) access: Access,
    mapped: bool,
}

impl fmt::Debug for Buffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Buffer({} bytes)", self.bytes)
    }
}

impl Buffer {
    /// Contents are undefined until written. `bytes` is a multiple of 4 above 0.
    pub(crate) fn new(memory: &Arc<Memory>, name: &str, place: Place, bytes: u64) -> Result<Self> {
        let charge = memory.budget.charge(bytes, name)?;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST;
        let info = vk::BufferCreateInfo::default().size(bytes).usage(usage);
        let raw = &memory.raw;
        // SAFETY: the size is not 0; the wrapper below takes ownership.
        let handle = unsafe { raw.device.create_buffer(&info, None) }.map_err(failed("creating a buffer"))?;
        let handle = BufferHandle::new(raw, handle);
        raw.name(handle.handle, name);
        // SAFETY: the buffer is alive.
        let requirements = unsafe { raw.device.get_buffer_memory_requirements(handle.handle) };
        let allocated = memory.allocate(name, place, requirements)?;
        // SAFETY: fresh memory of a type the buffer allows, at the offset the allocator chose for it.
        unsafe {
            let allocation = &allocated.allocation;
            raw.device.bind_buffer_memory(handle.handle, allocation.memory(), allocation.offset())
        }
        .map_err(failed("binding a buffer's memory"))?;
        let mapped = place == Place::Staging || memory.direct;
        Ok(Self { handle, allocated, _charge: charge, bytes, access: Access::default(), mapped })
    }

    pub(crate) fn handle(&self) -> vk::Buffer {
        self.handle.handle
    }

    fn pointer(&self) -> Result<NonNull<u8>> {
        let pointer = self.mapped.then(|| self.allocated.allocation.mapped_ptr()).flatten();
        pointer.map(NonNull::cast).ok_or_else(|| Error::internal("a buffer is not mapped"))
    }

    /// Hands the bytes to `read` while the device leaves them alone.
    pub(crate) fn with_bytes<R>(&self, read: impl FnOnce(&[u8]) -> R) -> Result<R> {
        let _guard = self.access.host()?;
        let pointer = self.pointer()?;
        // SAFETY: the allocation is at least `bytes` long and mapped while `self` lives; the guard keeps
        // the device from writing and `self` is shared, so nobody else writes either. Any bits are bytes.
        Ok(read(unsafe { std::slice::from_raw_parts(pointer.as_ptr(), self.bytes as usize) }))
    }

    /// Hands the bytes to `write` while nobody else has them.
    pub(crate) fn with_bytes_mut<R>(&mut self, write: impl FnOnce(&mut [u8]) -> R) -> Result<R> {
        let _guard = self.access.host()?;
        let pointer = self.pointer()?;
        // SAFETY: as in `with_bytes`, and `self` is borrowed alone.
        Ok(write(unsafe { std::slice::from_raw_parts_mut(pointer.as_ptr(), self.bytes as usize) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_refuses_what_does_not_fit_and_says_what_is_left() {
        let budget = Budget::new(100);
        let first = budget.charge(60, "first").expect("fits");
        let refused = budget.charge(41, "second").expect_err("does not fit");
        assert_eq!(refused.kind, ErrorKind::OutOfMemory);
        assert!(refused.message.contains("'second' needs 41 bytes"), "{}", refused.message);
        assert!(refused.message.contains("40 are available"), "{}", refused.message);
        drop(first);
        assert_eq!(budget.used_bytes(), 0);
        budget.charge(100, "third").expect("fits again");
        budget.charge(u64::MAX, "fourth").expect_err("does not overflow");
    }
}
