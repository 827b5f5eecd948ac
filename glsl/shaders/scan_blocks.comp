#version 460
#extension GL_GOOGLE_include_directive : require
// Prefix sum, second pass: one workgroup turns the block sums into exclusive offsets, in place, and writes
// the total as two words, so that the host can tell a total beyond 32 bits.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // blocks
} params;

PAGED(0, , uint64_t, block_sums);
PAGED(1, writeonly, uint, total);

shared uint64_t sums[64];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint chunk = (params.count + 63u) / 64u;
    uint first = min(lane * chunk, params.count);
    uint end = min(first + chunk, params.count);
    uint64_t sum = 0ul;
    for (uint i = first; i < end; ++i) {
        sum += LOAD(block_sums, i);
    }
    sums[lane] = sum;
    barrier();
    uint64_t before = 0ul;
    for (uint k = 0u; k < lane; ++k) {
        before += sums[k];
    }
    if (lane == 63u) {
        uint64_t all = before + sum;
        STORE(total, 0u, uint(all));
        STORE(total, 1u, uint(all >> 32));
    }
    for (uint i = first; i < end; ++i) {
        uint64_t value = LOAD(block_sums, i);
        STORE(block_sums, i, before);
        before += value;
    }
}
