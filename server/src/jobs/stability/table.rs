//! Every scenario: a file, and a row here.

use super::{cracks, grazing, row::Row, steps};

pub(super) const TABLE: &[&Row] = &[&grazing::ROW, &steps::MISSES, &steps::STAIRS, &cracks::ROW];
