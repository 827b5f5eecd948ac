//! Passes over lists, as every refinement and raster step needs them. No workgroup waits for another: Vulkan promises
//! no progress between them.
//!
//! | file | passes | makes |
//! |---|---|---|
//! | `scan.rs` | scan_sums, scan_blocks, scan | exclusive prefix sums |
//! | `compact.rs` | compact | the numbers of flagged items |
//! | `expand.rs` | expand | as many places as each item counts |
//! | `sort.rs` | sort_counts, sort_scatter | records by their keys, equal ones in their order |

pub mod compact;
pub mod expand;
pub mod scan;
pub mod sort;
