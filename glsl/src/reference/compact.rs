//! Twin of `compact`.

/// The numbers of the flagged items.
#[must_use]
pub fn kept(flags: &[u32]) -> Vec<u32> {
    (0..flags.len() as u32).filter(|&i| flags[i as usize] != 0).collect()
}
