#version 460
// Counts the triangles around each vertex.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, Facet, triangles);
PAGED(1, , uint, star_counts); // 0 before

void element(uint i) {
    uvec3 gv = LOAD(triangles, i).gv;
    for (uint k = 0u; k < 3u; ++k) {
        atomicAdd(ELEMENT(star_counts, gv[k]), 1u);
    }
}

#include "batch.glsl"
