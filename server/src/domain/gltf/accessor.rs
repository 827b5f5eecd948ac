//! Accessors: typed elements in buffer views, with sparse replacements.

use super::{
    json::At,
    source::{Source, View},
};
use crate::domain::{Error, Result};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn read(at: &At<'_>) -> Result<Self> {
        Ok(match at.whole_here()? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => {
                return Err(at.error(format!("{other} is no component type; there are 5120 to 5123, 5125 and 5126")));
            }
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value of a component; `normalized` maps integers to [0, 1] or [−1, 1].
    fn value(self, b: &[u8], normalized: bool) -> f32 {
        let (value, unit) = match self {
            Self::I8 => (f32::from(b[0] as i8), 127.0),
            Self::U8 => (f32::from(b[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => (self.integer(b) as f32, 4_294_967_295.0),
            Self::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        };
        if normalized { (value / unit).max(-1.0) } else { value }
    }

    fn integer(self, b: &[u8]) -> u32 {
        match self {
            Self::I8 | Self::U8 => u32::from(b[0]),
            Self::I16 | Self::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 | Self::F32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }
}

/// A checked accessor: all its bytes exist.
#[derive(Clone, Debug)]
pub(super) struct Accessor {
    pub(super) path: String,
    pub(super) component: Component,
    /// Rows and columns: 4 and 1 for VEC4, 4 and 4 for MAT4.
    shape: (usize, usize),
    pub(super) count: usize,
    pub(super) normalized: bool,
    data: Option<Data>,
    sparse: Option<Sparse>,
}

#[derive(Clone, Copy, Debug)]
struct Data {
    view: usize,
    offset: usize,
    stride: usize,
}

#[derive(Clone, Debug)]
struct Sparse {
    count: usize,
    component: Component,
    indices: Data,
    values: Data,
}

impl Accessor {
    pub(super) fn read(at: &At<'_>, views: &[View]) -> Result<Self> {
        let count = at.need_whole("count")?;
        let count = u32::try_from(count).ok().filter(|n| *n > 0);
        let count = count.ok_or_else(|| at.error("count is not within 1 to 4294967295"))? as usize;
        let mut accessor = Self {
            path: at.path.clone(),
            component: Component::read(&at.need("componentType")?)?,
            shape: shape(&at.need("type")?)?,
            count,
            normalized: at.flag("normalized")?,
            data: None,
            sparse: None,
        };
        let element = accessor.element_bytes();
        if at.get("bufferView").is_some() {
            accessor.data = Some(data(at, views, count, element, accessor.component.bytes())?);
        }
        if let Some(sparse) = at.get("sparse") {
            accessor.sparse = Some(accessor.read_sparse(&sparse, views)?);
        }
        Ok(accessor)
    }

    fn read_sparse(&self, at: &At<'_>, views: &[View]) -> Result<Sparse> {
        let count = at.need_whole("count")?;
        let count = usize::try_from(count).ok().filter(|n| (1..=self.count).contains(n));
        let count = count.ok_or_else(|| at.error(format!("count is not within 1 to the accessor's {}", self.count)))?;
        let indices = at.need("indices")?;
        let component = Component::read(&indices.need("componentType")?)?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(indices.error("componentType must be 5121, 5123 or 5125"));
        }
        let values = at.need("values")?;
        Ok(Sparse {
            count,
            component,
            indices: data(&indices, views, count, component.bytes(), component.bytes())?,
            values: data(&values, views, count, self.element_bytes(), self.component.bytes())?,
        })
    }

    pub(super) fn components(&self) -> usize {
        self.shape.0 * self.shape.1
    }

    pub(super) fn is_matrix(&self) -> bool {
        self.shape.1 > 1
    }

    /// Columns of matrices start at multiples of 4 bytes.
    fn column_bytes(&self) -> usize {
        let bytes = self.shape.0 * self.component.bytes();
        if self.is_matrix() { bytes.next_multiple_of(4) } else { bytes }
    }

    fn element_bytes(&self) -> usize {
        self.column_bytes() * self.shape.1
    }

    /// All components of all elements, normalised integers as the values they stand for.
    pub(super) fn floats(&self, source: &Source<'_>) -> Result<Vec<f32>> {
        source.charge(&self.path, (self.count * self.components()) as u64 * 4)?;
        let read = |bytes: &[u8], out: &mut [f32]| self.element(bytes, out);
        let mut values = vec![0.0; self.count * self.components()];
        if let Some(data) = self.data {
            let bytes = &source.views[data.view].bytes[data.offset..];
            let elements = (0..self.count).map(|i| &bytes[i * data.stride..][..self.element_bytes()]);
            values.chunks_exact_mut(self.components()).zip(elements).for_each(|(out, bytes)| read(bytes, out));
        }
        if let Some(sparse) = &self.sparse {
            self.for_each_sparse(sparse, source, |i, bytes| {
                read(bytes, &mut values[i * self.components()..][..self.components()])
            })?;
        }
        Ok(values)
    }

    fn element(&self, bytes: &[u8], out: &mut [f32]) {
        let size = self.component.bytes();
        for (column, out) in bytes.chunks_exact(self.column_bytes()).zip(out.chunks_exact_mut(self.shape.0)) {
            for (component, out) in column.chunks_exact(size).zip(out) {
                *out = self.component.value(component, self.normalized);
            }
        }
    }

    /// Scalar integers, such as indices.
    pub(super) fn integers(&self, source: &Source<'_>) -> Result<Vec<u32>> {
        let unsigned = matches!(self.component, Component::U8 | Component::U16 | Component::U32);
        if self.components() != 1 || !unsigned || self.normalized {
            return Err(Error::invalid(
                &self.path,
                "indices must be SCALAR of type 5121, 5123 or 5125, not normalized",
            ));
        }
        source.charge(&self.path, self.count as u64 * 4)?;
        let mut values = vec![0; self.count];
        if let Some(data) = self.data {
            let bytes = &source.views[data.view].bytes[data.offset..];
            let elements = bytes.chunks(data.stride).take(self.count);
            values.iter_mut().zip(elements).for_each(|(out, bytes)| *out = self.component.integer(bytes));
        }
        if let Some(sparse) = &self.sparse {
            self.for_each_sparse(sparse, source, |i, bytes| values[i] = self.component.integer(bytes))?;
        }
        Ok(values)
    }

    fn for_each_sparse(&self, sparse: &Sparse, source: &Source<'_>, mut put: impl FnMut(usize, &[u8])) -> Result<()> {
        let indices = &source.views[sparse.indices.view].bytes[sparse.indices.offset..];
        let values = &source.views[sparse.values.view].bytes[sparse.values.offset..];
        for k in 0..sparse.count {
            let index = sparse.component.integer(&indices[k * sparse.indices.stride..]) as usize;
            if index >= self.count {
                let message = format!("sparse index {index} is out of range; the accessor has {} elements", self.count);
                return Err(Error::invalid(&self.path, message));
            }
            put(index, &values[k * sparse.values.stride..][..self.element_bytes()]);
        }
        Ok(())
    }
}

fn shape(at: &At<'_>) -> Result<(usize, usize)> {
    Ok(match at.text_here()? {
        "SCALAR" => (1, 1),
        "VEC2" => (2, 1),
        "VEC3" => (3, 1),
        "VEC4" => (4, 1),
        "MAT2" => (2, 2),
        "MAT3" => (3, 3),
        "MAT4" => (4, 4),
        other => return Err(at.error(format!("'{other}' is none of SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 and MAT4"))),
    })
}

/// Checks that `count` elements of `element` bytes lie in the view and start at multiples of `alignment`.
fn data(at: &At<'_>, views: &[View], count: usize, element: usize, alignment: usize) -> Result<Data> {
    let view = at.need("bufferView")?.index_here(views.len(), "bufferViews")?;
    let offset = at.whole("byteOffset")?.unwrap_or(0);
    let View { bytes, stride } = &views[view];
    let stride = stride.unwrap_or(element);
    if stride < element {
        return Err(at.error(format!("elements have {element} bytes and the buffer view's byteStride is {stride}")));
    }
    // All fit u64: count is below 2^32, stride at most 252 or the 64 bytes of the largest element.
    let needed = (count as u64 - 1) * stride as u64 + element as u64;
    if offset.checked_add(needed).is_none_or(|end| end > bytes.len() as u64) {
        let message =
            format!("{count} elements from byte {offset} need {needed} bytes and the buffer view has {}", bytes.len());
        return Err(at.error(message));
    }
    if !offset.is_multiple_of(alignment as u64) {
        return Err(at.error(format!("byteOffset {offset} is not a multiple of the component's {alignment} bytes")));
    }
    Ok(Data { view, offset: offset as usize, stride })
}
