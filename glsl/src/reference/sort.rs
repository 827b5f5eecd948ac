//! Twin of `sort_counts` and `sort_scatter`, over all digits.

/// Records (key, value) by the lowest `bits` of their keys; equal ones keep their order.
#[must_use]
pub fn sorted(records: &[[u32; 2]], bits: u32) -> Vec<[u32; 2]> {
    let mask = ((1u64 << bits) - 1) as u32;
    let mut records = records.to_vec();
    records.sort_by_key(|record| record[0] & mask);
    records
}
