#version 460
// Where the triangles that change by moves would lie.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"
#include "bound.glsl"
#include "simplify.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
    uint first; // the number of the first vertex in the list
} params;

PAGED(3, readonly, RefinedVertex, vertices);
PAGED(4, readonly, RefineBase, bases);
PAGED(5, readonly, uint, list);
PAGED(6, readonly, uvec2, slots);
PAGED(7, readonly, uint, move_to);
PAGED(8, readonly, uvec2, places); // slot, and which of its triangles
PAGED(9, writeonly, FacetPlace, facets);

uvec2 place_of(const uint vertex, const RefineBase base) {
    return barycentrics(LOAD(vertices, vertex), base).yz;
}

void element(uint i) {
    uvec2 place = LOAD(places, i);
    uint vertex = LOAD(list, params.first + LOAD(slots, place.x).x);
    uint to = LOAD(move_to, place.x);
    uint first = LOAD(star_first, vertex);
    uint left = place.y;
    Facet facet;
    for (uint k = 0u; k < MOST_AROUND; ++k) {
        facet = facet_of(LOAD(star_items, first + k));
        if (!has(facet, to) && left-- == 0u) {
            break;
        }
    }
    uvec3 gv = moved(facet, vertex, to).gv;
    RefineBase base = LOAD(bases, facet.base);
    STORE(facets, i, FacetPlace(facet.base, place_of(gv.x, base), place_of(gv.y, base), place_of(gv.z, base)));
}

#include "batch.glsl"
