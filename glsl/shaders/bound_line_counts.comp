#version 460
// How many lines each triangle needs: one for each side of each seam whose ramp reaches it. None where the bound without
// ramps is above the cap already.
#include "common.glsl"
#include "pages.glsl"
#include "bound.glsl"
#include "bound_facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
    float cap;
} params;

PAGED(2, readonly, Ramps, ramps);
PAGED(3, readonly, float, bounds);
PAGED(4, writeonly, uint, line_counts);

uint lines_of(const uint i) {
    FacetPlace facet = LOAD(facets, i);
    BoundTriangle triangle = LOAD(bound_triangles, facet.base);
    if (triangle.ramps == NO_RAMPS || LOAD(bounds, i) > params.cap) {
        return 0u;
    }
    Ramps sides = LOAD(ramps, triangle.ramps);
    bvec3 wanted = reached(sides, units_of(facet.a), units_of(facet.b), units_of(facet.c));
    return uint(dot(vec3(wanted), vec3(sides.count)));
}

void element(uint i) {
    STORE(line_counts, i, lines_of(i));
}

#include "batch.glsl"
