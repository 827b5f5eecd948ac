#version 460
// The flip of one of each triangle's sides that gains most, of equal ones the first: listed with the triangle itself, or
// with the one across.
#include "common.glsl"
#include "pages.glsl"
#include "simplify.glsl"
#include "flip.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;      // triangles
    float tolerance; // local units
} params;

PAGED(3, readonly, float, errors);
PAGED(4, readonly, Flip, flips);
PAGED(5, readonly, uint, flip_counts);
PAGED(6, readonly, uint, flip_offsets);
PAGED(7, readonly, float, bounds);  // of the triangles that come of flips
PAGED(8, writeonly, uint, choices); // side of a triangle, or NOWHERE

// By how much the larger error falls; 0 where a side is not turned.
float gain(const uint side) {
    if (LOAD(flip_counts, side) == 0u) {
        return 0.0;
    }
    uint first = LOAD(flip_offsets, side);
    float before = max(LOAD(errors, side / 3u), LOAD(errors, LOAD(flips, side).other));
    return before - max(LOAD(bounds, first), LOAD(bounds, first + 1u));
}

// The lowest-numbered triangle at side ab, and its side there.
uint listed(const uint t, const uint side) {
    uvec3 abc = turned(facet_of(t).gv, side);
    uint first = LOAD(star_first, abc.x);
    uint count = LOAD(star_first, abc.x + 1u) - first;
    for (uint k = 0u; k < count; ++k) {
        uint other = LOAD(star_items, first + k);
        uvec3 gv = facet_of(other).gv;
        bvec3 ends = bvec3(gv.x == abc.y, gv.y == abc.y, gv.z == abc.y);
        if (other < t && any(ends)) {
            uvec3 next = gv.yzx;
            // The side that starts at b, or, between triangles that run against each other, ends there.
            uint start = ends.x ? 0u : (ends.y ? 1u : 2u);
            return 3u * other + (next[start] == abc.x ? start : (start + 2u) % 3u);
        }
    }
    return 3u * t + side;
}

void element(uint i) {
    uint choice = NOWHERE;
    float best = LEAST_GAIN * params.tolerance;
    [[dont_unroll]] for (uint k = 0u; k < 3u; ++k) {
        uint side = listed(i, k);
        float more = gain(side);
        if (more > best) {
            best = more;
            choice = side;
        }
    }
    STORE(choices, i, choice);
}

#include "batch.glsl"
