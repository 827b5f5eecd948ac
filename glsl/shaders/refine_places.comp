#version 460
// Where listed triangles lie in their base triangles.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"
#include "bound.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // listed
} params;

PAGED(0, readonly, uint, list);
PAGED(1, readonly, RefinedTriangle, triangles);
PAGED(2, readonly, RefinedVertex, vertices);
PAGED(3, readonly, RefineBase, bases);
PAGED(4, writeonly, FacetPlace, facets);

uvec2 place_of(const uint vertex, const RefineBase base) {
    return barycentrics(LOAD(vertices, vertex), base).yz;
}

void element(uint i) {
    RefinedTriangle triangle = LOAD(triangles, LOAD(list, i));
    RefineBase base = LOAD(bases, triangle.base);
    uvec3 gv = triangle.gv;
    STORE(facets, i, FacetPlace(triangle.base, place_of(gv.x, base), place_of(gv.y, base), place_of(gv.z, base)));
}

#include "batch.glsl"
