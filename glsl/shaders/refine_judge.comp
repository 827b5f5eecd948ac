#version 460
// Tells of listed triangles whether their bound is within what is allowed, and wants those split whose is not.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;    // listed
    float allowed; // local units
} params;

PAGED(0, readonly, uint, list);
PAGED(1, readonly, float, bounds);
PAGED(2, writeonly, uint, states);
PAGED(3, writeonly, uint, wanted); // 1: split this triangle

const uint GOOD = 1u;
const uint BAD = 2u;

void element(uint i) {
    uint triangle = LOAD(list, i);
    bool keeps = LOAD(bounds, i) <= params.allowed;
    STORE(states, triangle, keeps ? GOOD : BAD);
    STORE(wanted, triangle, keeps ? 0u : 1u);
}

#include "batch.glsl"
