#version 460
// Positions of vertices without detail: the base surface itself.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first;
} params;

PAGED(0, readonly, vec4, base_position_u);
PAGED(1, writeonly, vec3, positions);

void element(uint i) {
    i += params.first;
    STORE(positions, i, LOAD(base_position_u, i).xyz);
}

#include "batch.glsl"
