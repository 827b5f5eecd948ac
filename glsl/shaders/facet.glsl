// Triangles of a mesh that is being simplified. Mirrored in layout/simplify.rs.

struct Facet {
    uvec3 gv;
    uint base;
};

// Where a vertex would go, and the largest error of the triangles that come of it, local units.
struct Candidate {
    uint to; // or NOWHERE
    float error;
};

const uint NOWHERE = 0xffffffffu;
