#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
// Known answer: 64-bit atomics carry across their halves and lose no update.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
} params;

PAGED(0, , uint64_t, words); // sum, least, greatest

void main() {
    uint i = thread_index();
    if (i >= params.count) {
        return;
    }
    uint64_t key = (uint64_t(i * 2654435761u) << 32) | uint64_t(i);
    atomicAdd(ELEMENT(words, 0u), uint64_t(0xFFFFFFFFu) + uint64_t(i));
    atomicMin(ELEMENT(words, 1u), key + 1ul);
    atomicMax(ELEMENT(words, 2u), key);
}
