#version 460
// Lists the places where details are evaluated: a block of fine vertices in each base triangle around
// them, places that the host lists, or the sides of seams.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "sample.glsl"
#include "seams.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint start; // number of the first sample in its block or in `places`
    uint block;
    uint side;  // OWN, or the side of the triangle whose ramp is added
    uint rank;  // of the seam's side
    uint rule;
    Lattice lattice;
} params;

PAGED(0, readonly, BaseTriangle, base_triangles);
PAGED(1, readonly, BaseEdge, base_edges);
PAGED(2, readonly, uint, contributions); // triangle * 3 + corner (or side) of each vertex (or edge)
PAGED(3, readonly, uint, triangle_order);
PAGED(4, readonly, SeamSide, seam_corners);
PAGED(5, readonly, Seam, seams);
PAGED(6, readonly, SeamSide, seam_sides);
PAGED(7, readonly, uint, triangle_correction); // index into corrections, or NONE
PAGED(8, readonly, Correction, corrections);
PAGED(9, writeonly, Sample, samples);

// A place in a base triangle, by the weights of its second and its third corner.
struct TrianglePlace {
    uint triangle;
    vec2 b;
};

PAGED(10, readonly, TrianglePlace, places); // of block PLACES

// Blocks beyond those of lattice.glsl.
const uint SEAM_CORNERS = 3u;
const uint SEAM_EDGES = 4u;
const uint PLACES = 5u;
const uint OWN = 3u;

const Sample NOTHING = Sample(uvec3(0u), NONE, vec2(0.0), 0u, vec3(0.0), vec2(0.0));
// Site.patch_code of a place at an attribute vertex.
const uint AT_VERTEX = 0xffffffffu;
const vec3 FULL = vec3(1.0, 0.0, 0.0);

Sample corner_sample(const uint at) {
    SeamSide corner = LOAD(seam_corners, at);
    return Sample(uvec3(corner.id), corner.detail, vec2(0.0), AT_VERTEX, FULL, vec2(1.0));
}

Sample edge_sample(const uint side, const float t) {
    SeamSide entry = LOAD(seam_sides, side);
    BaseEdge edge = LOAD(base_edges, entry.id);
    return Sample(edge.av.xyy, entry.detail, vec2(t, 0.0), edge.patch_code, FULL, vec2(1.0));
}

// Component k of the barycentrics, as a jet.
vec3 weight_jet(const vec3 b, const uint k) {
    return k == 0u ? vec3(b.x, -1.0, -1.0) : (k == 1u ? vec3(b.y, 1.0, 0.0) : vec3(b.z, 0.0, 1.0));
}

// What side `rank` of the seam along `side` adds at b: w (share − own) of its candidate at t.
Sample ramp_sample(const uint t, const BaseTriangle triangle, const vec3 b) {
    uint list = LOAD(triangle_correction, t);
    if (list == NONE) {
        return NOTHING;
    }
    Correction correction = LOAD(corrections, list);
    uint which = correction.seam[params.side];
    vec3 weight = FULL - weight_jet(b, (params.side + 2u) % 3u) * correction.inverse_width[params.side];
    if (which == NONE || weight.x <= 0.0) {
        return NOTHING;
    }
    Seam seam = LOAD(seams, which);
    if (params.rank >= seam.count || LOAD(seam_sides, seam.first + params.rank).same_as != params.rank) {
        return NOTHING;
    }
    bool reversed = (triangle.reversed >> params.side & 1u) == 1u;
    uint next = (params.side + 1u) % 3u;
    vec3 to = weight_jet(b, reversed ? params.side : next);
    vec3 from = weight_jet(b, reversed ? next : params.side);
    float both = to.x + from.x;
    Sample result = edge_sample(seam.first + params.rank, to.x / both);
    float own = correction.rank[params.side] == params.rank ? 1.0 : 0.0;
    result.weight = weight * (share(seam, params.rule, params.rank) - own);
    result.turn = (from.x * to.yz - to.x * from.yz) / (both * both);
    return result;
}

// The lattice point of sample `index` of a block of fine vertices, and its base triangle.
uvec2 lattice_point(const uint index, out uint t) {
    uint n = 1u << params.lattice.level;
    if (params.block == INTERIORS) {
        uint points = interior_points(n);
        uint list = index / points;
        t = LOAD(triangle_order, list);
        return interior_point(n, index - list * points);
    }
    uint points = params.block == EDGES ? n - 1u : 1u;
    uint item = LOAD(contributions, index / points);
    t = item / 3u;
    uint k = item - 3u * t;
    // Steps along the triangle's side from corner k: none, or the ae's turned the triangle's way.
    uint along = 0u;
    if (params.block == EDGES) {
        along = index % points + 1u;
        bool reversed = (LOAD(base_triangles, t).reversed >> k & 1u) == 1u;
        along = reversed ? n - along : along;
    }
    uint left = n - along;
    return k == 0u ? uvec2(along, 0u) : (k == 1u ? uvec2(left, along) : uvec2(0u, left));
}

// The weights of the second and the third corner at sample `index`, and its base triangle.
vec2 weights_at(const uint index, out uint t) {
    if (params.block == PLACES) {
        TrianglePlace place = LOAD(places, index);
        t = place.triangle;
        return place.b;
    }
    return vec2(lattice_point(index, t)) / float(1u << params.lattice.level);
}

Sample sample_at(const uint index) {
    uint n = 1u << params.lattice.level;
    if (params.block == SEAM_CORNERS) {
        return corner_sample(index);
    }
    if (params.block == SEAM_EDGES) {
        uint side = index / (n - 1u);
        return edge_sample(side, float(index - side * (n - 1u) + 1u) / float(n));
    }
    uint t;
    vec2 b = weights_at(index, t);
    BaseTriangle triangle = LOAD(base_triangles, t);
    if (params.side == OWN) {
        return Sample(triangle.av, triangle.detail, b, 8u * t, FULL, vec2(1.0));
    }
    return ramp_sample(t, triangle, vec3(1.0 - b.x - b.y, b));
}

void element(uint i) {
    STORE(samples, i, sample_at(i + params.start));
}

#include "batch.glsl"
