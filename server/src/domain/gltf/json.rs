//! A value of the document that knows its path, so that every error can name it.

use serde_json::Value;

use crate::domain::{Error, Result};

/// A JSON value and where it is, such as `meshes[0].primitives[1]`.
#[derive(Clone, Debug)]
pub(super) struct At<'a> {
    pub(super) value: &'a Value,
    pub(super) path: String,
}

impl<'a> At<'a> {
    pub(super) fn root(value: &'a Value) -> Self {
        Self { value, path: String::new() }
    }

    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        Error::invalid(self.name(), message)
    }

    pub(super) fn unsupported(&self, message: impl Into<String>) -> Error {
        Error::unsupported(self.name(), message)
    }

    pub(super) fn name(&self) -> String {
        if self.path.is_empty() { "document".into() } else { self.path.clone() }
    }

    pub(super) fn get(&self, key: &str) -> Option<At<'a>> {
        let value = self.value.as_object()?.get(key)?;
        Some(At { value, path: if self.path.is_empty() { key.into() } else { format!("{}.{key}", self.path) } })
    }

    pub(super) fn need(&self, key: &str) -> Result<At<'a>> {
        self.get(key).ok_or_else(|| self.error(format!("'{key}' is missing")))
    }

    /// The extension object `name` of this object.
    pub(super) fn extension(&self, name: &str) -> Option<At<'a>> {
        self.get("extensions")?.get(name)
    }

    /// The elements of this array.
    pub(super) fn items(&self) -> Result<Vec<At<'a>>> {
        let list = self.value.as_array().ok_or_else(|| self.error("is not an array"))?;
        Ok(list.iter().enumerate().map(|(i, value)| At { value, path: format!("{}[{i}]", self.path) }).collect())
    }

    /// The elements of the array `key`; none when it is missing.
    pub(super) fn list(&self, key: &str) -> Result<Vec<At<'a>>> {
        self.get(key).map_or(Ok(Vec::new()), |at| at.items())
    }

    /// Length of the array `key`; 0 when it is missing.
    pub(super) fn count(&self, key: &str) -> Result<usize> {
        let length = |at: At<'a>| at.value.as_array().map(Vec::len).ok_or_else(|| at.error("is not an array"));
        self.get(key).map_or(Ok(0), length)
    }

    /// Element `index` of the array `key`, which has it.
    pub(super) fn element(&self, key: &str, index: usize) -> Result<At<'a>> {
        let list = self.need(key)?;
        let value = list.value.get(index).ok_or_else(|| list.error(format!("has no element {index}")))?;
        Ok(At { value, path: format!("{}[{index}]", list.path) })
    }

    pub(super) fn object(&self) -> Result<&'a serde_json::Map<String, Value>> {
        self.value.as_object().ok_or_else(|| self.error("is not an object"))
    }

    pub(super) fn text_here(&self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.error("is not a string"))
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>> {
        self.get(key).map(|at| at.text_here()).transpose()
    }

    pub(super) fn flag(&self, key: &str) -> Result<bool> {
        let flag = |at: At<'a>| at.value.as_bool().ok_or_else(|| at.error("is not true or false"));
        self.get(key).map_or(Ok(false), flag)
    }

    /// A whole number; 5.0 counts as 5, as writers in some languages print it.
    pub(super) fn whole_here(&self) -> Result<u64> {
        let of_float = |x: f64| (x >= 0.0 && x.fract() == 0.0 && x < 9e15).then_some(x as u64);
        let number = self.value.as_u64().or_else(|| self.value.as_f64().and_then(of_float));
        number.ok_or_else(|| self.error(format!("{} is not a whole number", self.value)))
    }

    pub(super) fn whole(&self, key: &str) -> Result<Option<u64>> {
        self.get(key).map(|at| at.whole_here()).transpose()
    }

    pub(super) fn need_whole(&self, key: &str) -> Result<u64> {
        self.need(key)?.whole_here()
    }

    /// A number that is finite as f32 too.
    pub(super) fn number_here(&self) -> Result<f64> {
        let number = self.value.as_f64().filter(|x| (*x as f32).is_finite());
        number.ok_or_else(|| self.error("is not a finite number"))
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>> {
        self.get(key).map(|at| at.number_here()).transpose()
    }

    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>> {
        let Some(at) = self.get(key) else { return Ok(None) };
        let numbers: Vec<f64> = at.items()?.iter().map(At::number_here).collect::<Result<_>>()?;
        let exact =
            <[f64; N]>::try_from(numbers).map_err(|n| at.error(format!("has {} numbers; {N} are needed", n.len())))?;
        Ok(Some(exact))
    }

    /// This value as an index into one of `count` things called `things`.
    pub(super) fn index_here(&self, count: usize, things: &str) -> Result<usize> {
        let index = self.whole_here()?;
        let known = usize::try_from(index).ok().filter(|i| *i < count);
        known.ok_or_else(|| self.error(format!("{things}[{index}] does not exist; the file has {count} {things}")))
    }

    pub(super) fn index(&self, key: &str, count: usize, things: &str) -> Result<Option<usize>> {
        self.get(key).map(|at| at.index_here(count, things)).transpose()
    }
}
