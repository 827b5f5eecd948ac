// The bound of how far the displaced surface is from triangles with corners on it, over the same part of the base: height
// layers alone. The twin is `reference/bound.rs`; structs are mirrored in layout/bound.rs.
//
// One triangle is one region, and so is each line: a piece of a seam as one of its sides has it. A bound is made of passes
// that each do one thing over all regions, since GLSL inlines everything and drivers compile large passes slowly:
// bound_places where a region lies on a map, bound_maps what a map does over few texels, bound_sides, bound_starts and
// bound_large what it does over many, bound_fields what that comes to along directions that bend, and at seams
// bound_line_counts and bound_lines the lines that a triangle needs, bound_ramps their sum.
// Include after common.glsl and pages.glsl.

// A triangle within a base triangle: barycentrics b1, b2 of its corners, units of 2^-24.
struct FacetPlace {
    uint base;
    uvec2 a;
    uvec2 b;
    uvec2 c;
};

// A piece of an edge between two vertices: the units from the first at which it starts, ends, and a place in between.
struct Line {
    uvec2 av;
    uvec2 layers;
    uvec3 along;
};

struct BoundTriangle {
    uvec3 av;
    uvec2 layers;  // first, end
    uint reversed; // bit k: its ae k runs from corner k + 1 to corner k
    uint ramps;    // index, or NO_RAMPS
    float least;   // length of its directions
};

struct BoundVertex {
    vec3 direction;
    vec3 normal;
    vec3 correction; // local units; of corners at seams
};

// Texel space of a vertex under one layer of its detail: the sum of both, rest in [0, 1).
struct TexelPlace {
    ivec2 whole;
    vec2 rest;
};

// The ramps along the sides of a base triangle.
struct Ramps {
    uvec3 first; // of ramp_parts
    uvec3 count;
    vec3 inverse_width; // of a barycentric
};

// One side of a seam: it counts `share` times in what the triangle's own side is short of.
struct RampPart {
    uvec2 av;
    uvec2 layers;
    float share;
};

const uint NO_RAMPS = 0xffffffffu;
const uint WHOLE = 1u << 24;
const float SHARE = 1.0 / 16777216.0;
