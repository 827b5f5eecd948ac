#version 460
// Lists the triangles around each vertex, in no order.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, Facet, triangles);
PAGED(1, readonly, uint, star_first);
PAGED(2, , uint, star_filled); // 0 before
PAGED(3, writeonly, uint, star_items);

void element(uint i) {
    uvec3 gv = LOAD(triangles, i).gv;
    for (uint k = 0u; k < 3u; ++k) {
        uint place = LOAD(star_first, gv[k]) + atomicAdd(ELEMENT(star_filled, gv[k]), 1u);
        STORE(star_items, place, i);
    }
}

#include "batch.glsl"
