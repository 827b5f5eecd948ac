#version 460
// Adds what ramps come to, by the lines that triangles have, to their bounds.
#include "common.glsl"
#include "pages.glsl"
#include "bound.glsl"
#include "bound_facet.glsl"
#include "bound_field.glsl"
#include "bound_ramp.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(2, readonly, Ramps, ramps);
PAGED(3, readonly, RampPart, ramp_parts);
PAGED(4, readonly, uint, line_counts);
PAGED(5, readonly, uint, line_offsets);
PAGED(6, readonly, float, line_bounds);
PAGED(7, readonly, mat3, displaced);
PAGED(8, , float, bounds);

// Seams with more sides are refused.
const uint MOST_SIDES = 64u;

// The ramp whose sides of the seam are the parts `first` and on, by the lines `line` and on.
float side_bound(const Ramp ramp, const uint first, const uint count, const uint line) {
    mat3 short_of = mat3(0.0);
    float bend = 0.0;
    for (uint k = 0u; k < min(count, MOST_SIDES); ++k) {
        float share = LOAD(ramp_parts, first + k).share;
        short_of += share * LOAD(displaced, line + k);
        bend += abs(share) * LOAD(line_bounds, line + k);
    }
    return ramp_bound(ramp, short_of, bend);
}

void element(uint i) {
    if (LOAD(line_counts, i) == 0u) {
        return;
    }
    FacetPlace facet = LOAD(facets, i);
    BoundTriangle triangle = LOAD(bound_triangles, facet.base);
    Ramps sides = LOAD(ramps, triangle.ramps);
    uvec3 a = units_of(facet.a), b = units_of(facet.b), c = units_of(facet.c);
    uvec3 counts = mix(uvec3(0u), sides.count, reached(sides, a, b, c));
    uint line = LOAD(line_offsets, i);
    float sum = LOAD(bounds, i);
    [[dont_unroll]] for (uint side = 0u; side < 3u; ++side) {
        if (counts[side] > 0u) {
            Ramp ramp = ramp_of(side, sides.inverse_width[side], triangle.reversed, a, b, c);
            sum += side_bound(ramp, sides.first[side], counts[side], line);
            line += counts[side];
        }
    }
    STORE(bounds, i, sum);
}

#include "batch.glsl"
