#version 460
// Lists the lines that triangles need, in the order of their sides.
#include "common.glsl"
#include "pages.glsl"
#include "bound.glsl"
#include "bound_facet.glsl"
#include "bound_field.glsl"
#include "bound_ramp.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // lines
} params;

PAGED(2, readonly, Ramps, ramps);
PAGED(3, readonly, RampPart, ramp_parts);
PAGED(4, readonly, uvec2, places); // triangle, and number among its lines
PAGED(5, writeonly, Line, next_lines);

void element(uint i) {
    uvec2 place = LOAD(places, i);
    FacetPlace facet = LOAD(facets, place.x);
    BoundTriangle triangle = LOAD(bound_triangles, facet.base);
    Ramps sides = LOAD(ramps, triangle.ramps);
    uvec3 a = units_of(facet.a), b = units_of(facet.b), c = units_of(facet.c);
    uvec3 counts = mix(uvec3(0u), sides.count, reached(sides, a, b, c));
    uint side = place.y < counts.x ? 0u : (place.y < counts.x + counts.y ? 1u : 2u);
    uint before = side == 0u ? 0u : (side == 1u ? counts.x : counts.x + counts.y);
    RampPart part = LOAD(ramp_parts, sides.first[side] + place.y - before);
    Ramp ramp = ramp_of(side, sides.inverse_width[side], triangle.reversed, a, b, c);
    STORE(next_lines, i, Line(part.av, part.layers, ramp.along));
}

#include "batch.glsl"
