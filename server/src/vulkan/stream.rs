//! Streams: typed arrays on the device, cut into pages so that no binding exceeds 128 MiB.

use std::{ops::Range, sync::Arc};

use bytemuck::Pod;

use super::{
    device::Device,
    error::{Error, ErrorKind, Result},
    features::MAX_BINDING_BYTES,
    memory::{Buffer, Place},
};

/// Elements of a page, as `pages.glsl` has it.
pub const PAGE_SHIFT: u32 = 22;
/// Pages a shader can see at once, as `pages.glsl` has it.
pub const MAX_PAGES: u64 = 16;
/// Pages of texels hold so many times as many elements, as a power of two, as `pages.glsl` has it: each is a word of 4
/// bytes, not up to 32.
pub const TEXELS_MORE_SHIFT: u32 = 3;

/// An array of elements on the device. Dropping it while work that uses it is recorded or runs is fine:
/// the recorder keeps what it needs.
#[derive(Debug)]
pub struct Stream {
    device: Arc<Device>,
    name: String,
    element_bytes: u32,
    len: u64,
    /// Elements of a page.
    page_len: u64,
    pages: Vec<Arc<Buffer>>,
}

impl Stream {
    /// A stream of `len` elements whose contents are undefined until written. `OutOfMemory` if it does not
    /// fit the device's budget.
    pub fn new(device: &Arc<Device>, name: &str, element_bytes: u32, len: u64) -> Result<Self> {
        let page_len = 1 << device.page_shift();
        let pages = new_pages(device, name, element_bytes, len, page_len)?;
        Ok(Self::from_pages(device, name, element_bytes, len, page_len, pages))
    }

    /// A stream that holds `elements`.
    pub fn from_slice<T: Pod>(device: &Arc<Device>, name: &str, elements: &[T]) -> Result<Self> {
        Self::build(device, name, elements.len() as u64, |first, page: &mut [T]| {
            page.copy_from_slice(&elements[first as usize..][..page.len()]);
        })
    }

    /// A stream written in place by `write(first, elements)`, called for successive ranges. Where the
    /// device's memory is the host's, nothing is copied. `elements` holds garbage before it is written.
    pub fn build<T: Pod>(device: &Arc<Device>, name: &str, len: u64, write: impl FnMut(u64, &mut [T])) -> Result<Self> {
        Self::build_paged(device, name, len, 1 << device.page_shift(), write)
    }

    /// The values of maps, for shaders that read them by `LOAD_TEXEL`.
    pub fn of_texels(device: &Arc<Device>, texels: &[f32]) -> Result<Self> {
        let page_len = 1 << (device.page_shift() + TEXELS_MORE_SHIFT);
        Self::build_paged(device, "texels", texels.len() as u64, page_len, |first, page: &mut [f32]| {
            page.copy_from_slice(&texels[first as usize..][..page.len()]);
        })
    }

    /// Elements.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.len
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    #[must_use]
    pub fn element_bytes(&self) -> u32 {
        self.element_bytes
    }

    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.len * u64::from(self.element_bytes)
    }

    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All elements, or their parts: an element may be several `T`.
    pub fn read<T: Pod>(&self) -> Result<Vec<T>> {
        self.read_range(0..self.len)
    }

    /// The elements of a range, or their parts.
    pub fn read_range<T: Pod>(&self, range: Range<u64>) -> Result<Vec<T>> {
        let parts = self.parts::<T>()?;
        let mut all = Vec::with_capacity((range.end.saturating_sub(range.start) * parts) as usize);
        self.read_pages(range, |_, elements| all.extend_from_slice(elements))?;
        Ok(all)
    }

    /// Hands the elements of a range, or their parts, to `read(first, elements)` piece by piece, `first`
    /// counting elements. Where the device's memory is the host's, nothing is copied.
    pub fn read_pages<T: Pod>(&self, range: Range<u64>, mut read: impl FnMut(u64, &[T])) -> Result<()> {
        self.parts::<T>()?;
        if range.start > range.end || range.end > self.len {
            return Err(Error::internal(format!("'{}' has no elements {range:?}, it has {}", self.name, self.len)));
        }
        let (page_len, stride) = (self.page_len, u64::from(self.element_bytes));
        for (index, page) in self.pages.iter().enumerate() {
            let first = index as u64 * page_len;
            let start = range.start.max(first);
            let end = range.end.min(first + page_len);
            if start < end {
                let bytes = (start - first) * stride..(end - first) * stride;
                self.device.download(page, bytes, stride, |offset, bytes| {
                    read(first + offset / stride, cast(bytes)?);
                    Ok(())
                })?;
            }
        }
        Ok(())
    }

    pub(crate) fn pages(&self) -> &[Arc<Buffer>] {
        &self.pages
    }

    fn build_paged<T: Pod>(
        device: &Arc<Device>,
        name: &str,
        len: u64,
        page_len: u64,
        mut write: impl FnMut(u64, &mut [T]),
    ) -> Result<Self> {
        let element_bytes = size_of::<T>() as u32;
        let mut pages = new_pages(device, name, element_bytes, len, page_len)?;
        for (index, page) in pages.iter_mut().enumerate() {
            let first = index as u64 * page_len;
            device.upload(page, u64::from(element_bytes), |offset, bytes| {
                write(first + offset / u64::from(element_bytes), cast_mut(bytes)?);
                Ok(())
            })?;
        }
        Ok(Self::from_pages(device, name, element_bytes, len, page_len, pages))
    }

    fn from_pages(
        device: &Arc<Device>,
        name: &str,
        element_bytes: u32,
        len: u64,
        page_len: u64,
        pages: Vec<Buffer>,
    ) -> Self {
        let pages = pages.into_iter().map(Arc::new).collect();
        Self { device: device.clone(), name: name.into(), element_bytes, len, page_len, pages }
    }

    /// How many `T` an element is.
    fn parts<T>(&self) -> Result<u64> {
        let (element, part) = (self.element_bytes as usize, size_of::<T>());
        if part > 0 && element % part == 0 {
            return Ok((element / part) as u64);
        }
        Err(Error::internal(format!("'{}' has elements of {element} bytes, they are read as {part}", self.name)))
    }
}

/// The buffers of a stream, charged and allocated one by one; all are given back if one does not fit.
fn new_pages(device: &Device, name: &str, element_bytes: u32, len: u64, page_len: u64) -> Result<Vec<Buffer>> {
    let stride = u64::from(element_bytes);
    if element_bytes == 0 || !element_bytes.is_multiple_of(4) {
        return Err(Error::internal(format!("'{name}' has elements of {element_bytes} bytes; words of 4 are allowed")));
    }
    if len > page_len * MAX_PAGES || len.min(page_len) * stride > MAX_BINDING_BYTES {
        // Elements too large for a full page fit one page only.
        let most =
            if page_len * stride > MAX_BINDING_BYTES { MAX_BINDING_BYTES / stride } else { page_len * MAX_PAGES };
        return Err(Error::new(
            ErrorKind::OutOfMemory,
            format!("'{name}' has {len} elements of {stride} bytes; at most {most} fit a stream: ask for less detail"),
        ));
    }
    let lengths = (0..len.div_ceil(page_len)).map(|page| (len - page * page_len).min(page_len));
    lengths.map(|elements| Buffer::new(device.memory(), name, Place::Device, elements * stride)).collect()
}

fn cast<T: Pod>(bytes: &[u8]) -> Result<&[T]> {
    bytemuck::try_cast_slice(bytes).map_err(misaligned)
}

fn cast_mut<T: Pod>(bytes: &mut [u8]) -> Result<&mut [T]> {
    bytemuck::try_cast_slice_mut(bytes).map_err(misaligned)
}

fn misaligned(error: bytemuck::PodCastError) -> Error {
    Error::internal(format!("device memory does not hold these elements: {error}"))
}
