// Seams: where a geometric vertex or edge has several attribute vertices or edges whose displacements
// may differ. Corner corrections spread as hat functions, edge corrections as ramps, so that the surface
// is continuous (see `reference/seams.rs`).

// The sides of one geometric vertex or edge: `count` entries from `first`, `distinct` of them different.
struct Seam {
    uint first;
    uint count;
    uint distinct;
};

// A side: an av or an ae. `same_as` is the rank in its seam of the first side with the same candidates
// (its own where it is the first): equal sides count once.
struct SeamSide {
    uint id;
    uint detail;
    uint same_as;
};

// How a base triangle is corrected: per side the seam or NONE, the rank in it of the triangle's own
// candidates, and the inverse of the ramp's width as a barycentric.
struct Correction {
    uvec3 seam;
    uvec3 rank;
    vec3 inverse_width;
};

const uint RULE_MEAN = 0u;
const uint RULE_DOMINANT = 1u;

// Share of a side with this rank in the reconciled value.
float share(const Seam seam, const uint rule, const uint rank) {
    return rule == RULE_MEAN ? 1.0 / float(seam.distinct) : (rank == 0u ? 1.0 : 0.0);
}
