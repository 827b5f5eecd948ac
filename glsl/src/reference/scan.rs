//! Twin of `scan`: exclusive prefix sums.

/// The sum of the items before each one, and of all.
#[must_use]
pub fn exclusive_sums(items: &[u32]) -> (Vec<u64>, u64) {
    let mut total = 0u64;
    let mut offsets = Vec::with_capacity(items.len());
    for &item in items {
        offsets.push(total);
        total += u64::from(item);
    }
    (offsets, total)
}
