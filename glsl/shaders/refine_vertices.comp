#version 460
// Carries vertices over to the next round, which has room for more.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // vertices
} params;

PAGED(0, readonly, RefinedVertex, vertices);
PAGED(1, writeonly, RefinedVertex, next_vertices);

void element(uint i) {
    STORE(next_vertices, i, LOAD(vertices, i));
}

#include "batch.glsl"
