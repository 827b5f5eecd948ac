#version 460
// Flags the triangles that the last round made.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, uint, states); // 0 of new ones
PAGED(1, writeonly, uint, flags);

void element(uint i) {
    STORE(flags, i, LOAD(states, i) == 0u ? 1u : 0u);
}

#include "batch.glsl"
