#version 460
// Closes the gaps that triangles have left.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles before
} params;

PAGED(0, readonly, Facet, triangles);
PAGED(1, readonly, uint, kept);
PAGED(2, readonly, uint, offsets); // exclusive sums of kept
PAGED(3, writeonly, Facet, next_triangles);

void element(uint i) {
    if (LOAD(kept, i) != 0u) {
        STORE(next_triangles, LOAD(offsets, i), LOAD(triangles, i));
    }
}

#include "batch.glsl"
