// Triangles of a mesh that is being simplified. Mirrored in layout/simplify.rs.

struct Facet {
    uvec3 gv;
    uint base;
};

// What is known of drawing a vertex into a neighbour.
struct Candidate {
    uint to;     // the neighbour that costs least; NOWHERE: it may not go; UNSURE: any way costs at least the error
    float error; // the largest of the triangles that come of it, local units
};

const uint NOWHERE = 0xffffffffu;
const uint UNSURE = 0xfffffffeu;
