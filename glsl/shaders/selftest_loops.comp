#version 460
#extension GL_GOOGLE_include_directive : require
// Known answer: loops run as long as they say. Some drivers cut them at 65 535 iterations in silence.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;  // threads, one result each
    uint single; // iterations of the plain loop
    uint outer;  // iterations of the nested one
    uint inner;
} params;

PAGED(0, writeonly, uint, results);

// A linear congruential step: no compiler knows a short cut for many of them.
uint advance(uint state) {
    return state * 1664525u + 1013904223u;
}

void main() {
    uint i = thread_index();
    if (i >= params.count) {
        return;
    }
    uint state = i;
    for (uint k = 0u; k < params.single; ++k) {
        state = advance(state);
    }
    for (uint j = 0u; j < params.outer; ++j) {
        for (uint k = 0u; k < params.inner; ++k) {
            state = advance(state) ^ j;
        }
    }
    STORE(results, i, state);
}
