#version 460
// Where the triangles of a simplified mesh lie in their base triangles.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"
#include "bound.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, Facet, triangles);
PAGED(1, readonly, RefinedVertex, vertices);
PAGED(2, readonly, RefineBase, bases);
PAGED(3, writeonly, FacetPlace, facets);

uvec2 place_of(const uint vertex, const RefineBase base) {
    return barycentrics(LOAD(vertices, vertex), base).yz;
}

void element(uint i) {
    Facet facet = LOAD(triangles, i);
    RefineBase base = LOAD(bases, facet.base);
    uvec3 gv = facet.gv;
    STORE(facets, i, FacetPlace(facet.base, place_of(gv.x, base), place_of(gv.y, base), place_of(gv.z, base)));
}

#include "batch.glsl"
