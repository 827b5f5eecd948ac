#version 460
// Where the triangles that come of flips would lie.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"
#include "bound.glsl"
#include "facet.glsl"
#include "flip.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, Facet, triangles);
PAGED(1, readonly, RefinedVertex, vertices);
PAGED(2, readonly, RefineBase, bases);
PAGED(3, readonly, Flip, flips);
PAGED(4, readonly, uvec2, places); // side, and which of its triangles
PAGED(5, writeonly, FacetPlace, facets);

uvec2 place_of(const uint vertex, const RefineBase base) {
    return barycentrics(LOAD(vertices, vertex), base).yz;
}

void element(uint i) {
    uvec2 place = LOAD(places, i);
    uint t = place.x / 3u;
    Facet own = LOAD(triangles, t);
    uvec3 abc = turned(own.gv, place.x - 3u * t);
    uint d = LOAD(flips, place.x).d;
    uvec3 gv = place.y == 0u ? first_after(abc, d) : second_after(abc, d);
    RefineBase base = LOAD(bases, own.base);
    STORE(facets, i, FacetPlace(own.base, place_of(gv.x, base), place_of(gv.y, base), place_of(gv.z, base)));
}

#include "batch.glsl"
