//! Every scenario: a file, and a row here.

use super::{
    bounds, cracks, factors, foldover, grazing, grazing_images, highlights, outlines, pops, posts, row::Row, scales,
    seams, steps, swimming, tangents, terraces,
};

pub(super) const TABLE: &[&Row] = &[
    &grazing::ROW,
    &grazing_images::ROW,
    &steps::MISSES,
    &steps::STAIRS,
    &posts::POSTS,
    &posts::SLOTS,
    &outlines::ROW,
    &swimming::DRIFT,
    &swimming::SHIMMER,
    &pops::JUMPS,
    &pops::FLASHES,
    &cracks::ROW,
    &tangents::ROW,
    &foldover::INVERTED,
    &foldover::MEETING,
    &terraces::STEPS,
    &terraces::NORMALS,
    &highlights::ROW,
    &scales::STRETCHED,
    &scales::UNITS,
    &factors::FACTORS,
    &factors::JUNCTIONS,
    &seams::DIRECTIONS,
    &seams::TILING,
    &bounds::ROW,
];
