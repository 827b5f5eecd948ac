//! The shape of a fresh accessor and of the view it fills.

use serde_json::{Map, Value, json};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Least and greatest of each component, as they stand in the file.
pub(in super::super) type Bounds = ([f32; 3], [f32; 3]);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Component {
    U8,
    /// −32767 to 32767 for −1 to 1.
    Snorm16,
    U16,
    /// 0 to 65535 for 0 to 1.
    Unorm16,
    U32,
    F32,
}

impl Component {
    fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::Snorm16 | Self::U16 | Self::Unorm16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn number(self) -> u32 {
        match self {
            Self::U8 => 5121,
            Self::Snorm16 => 5122,
            Self::U16 | Self::Unorm16 => 5123,
            Self::U32 => 5125,
            Self::F32 => 5126,
        }
    }

    fn is_normalized(self) -> bool {
        matches!(self, Self::Snorm16 | Self::Unorm16)
    }
}

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Stream {
    pub(in super::super) component: Component,
    pub(in super::super) components: usize,
    pub(in super::super) count: usize,
    pub(in super::super) bounds: Option<Bounds>,
    /// Three to a triangle; else one for each vertex.
    pub(in super::super) is_indices: bool,
    /// Unit vectors in three components, and what a fourth may say.
    pub(in super::super) is_directions: bool,
}

impl Stream {
    pub(in super::super) fn of_vertices(component: Component, components: usize, count: usize) -> Self {
        Self { component, components, count, bounds: None, is_indices: false, is_directions: false }
    }

    pub(in super::super) fn of_indices(component: Component, count: usize) -> Self {
        Self { is_indices: true, ..Self::of_vertices(component, 1, count) }
    }

    /// Bytes of an element, those of its padding excluded.
    pub(in super::super) fn element_bytes(&self) -> usize {
        self.component.bytes() * self.components
    }

    /// Bytes from one element to the next; those of vertices begin at multiples of 4.
    pub(in super::super) fn stride(&self) -> usize {
        if self.is_indices { self.element_bytes() } else { self.element_bytes().next_multiple_of(4) }
    }

    pub(super) fn view(&self) -> Map<String, Value> {
        let mut view = Map::new();
        let target = if self.is_indices { ELEMENT_ARRAY_BUFFER } else { ARRAY_BUFFER };
        view.insert("target".into(), target.into());
        if self.stride() != self.element_bytes() {
            view.insert("byteStride".into(), self.stride().into());
        }
        view
    }

    pub(super) fn accessor(&self, view: usize) -> Value {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][(self.components - 1).min(3)];
        let mut accessor = json!({
            "bufferView": view,
            "componentType": self.component.number(),
            "count": self.count,
            "type": kind,
        });
        if self.component.is_normalized() {
            accessor["normalized"] = true.into();
        }
        if let Some((low, high)) = self.bounds {
            accessor["min"] = self.numbers(low);
            accessor["max"] = self.numbers(high);
        }
        accessor
    }

    /// Every f32 is an f64: printed and read back, they are the values themselves.
    fn numbers(&self, values: [f32; 3]) -> Value {
        match self.component {
            Component::F32 => values.map(f64::from).to_vec().into(),
            _ => values.map(|value| value as i64).to_vec().into(),
        }
    }
}
