#version 460
#extension GL_GOOGLE_include_directive : require
// Prefix sum, first of three passes: the sum of each block of 2048 items, a workgroup per block.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "scan_block.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;  // items
    uint blocks;
} params;

PAGED(0, readonly, uint, items);
PAGED(1, writeonly, uint64_t, block_sums);

shared uint64_t sums[64];

void main() {
    uint block = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
    if (block >= params.blocks) {
        return;
    }
    uint lane = gl_LocalInvocationID.x;
    uint first = block * ITEMS_PER_BLOCK + lane;
    uint64_t sum = 0ul;
    [[dont_unroll]] for (uint k = 0u; k < ITEMS_PER_THREAD; ++k) {
        uint i = first + k * 64u;
        sum += i < params.count ? uint64_t(LOAD(items, i)) : 0ul;
    }
    sums[lane] = sum;
    barrier();
    [[dont_unroll]] for (uint width = 32u; width > 0u; width >>= 1) {
        if (lane < width) {
            sums[lane] += sums[lane + width];
        }
        barrier();
    }
    if (lane == 0u) {
        STORE(block_sums, block, sums[0]);
    }
}
