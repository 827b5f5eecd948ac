//! Twin of `expand`.

/// As many places as each item counts: the item, and the number among its places.
#[must_use]
pub fn places(counts: &[u32]) -> Vec<[u32; 2]> {
    (0..counts.len() as u32).flat_map(|item| (0..counts[item as usize]).map(move |rank| [item, rank])).collect()
}
