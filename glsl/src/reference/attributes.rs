//! Interpolated attributes. The twin of `attributes.comp`.

use super::site::Site;
use crate::tables::Tables;

/// Component `k` of `components` of vertex `index` of a block.
#[must_use]
pub fn value(tables: &Tables, values: &[f32], components: usize, which: u32, index: u32, k: usize) -> f64 {
    let site = Site::of(tables, which, index);
    let at = |corner: usize| f64::from(values[site.av[corner] as usize * components + k]);
    site.b.x * at(0) + site.b.y * at(1) + site.b.z * at(2)
}
