#version 460
#extension GL_GOOGLE_include_directive : require
// Prefix sum, last pass: exclusive sums of all items, a workgroup per block of 2048.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "scan_block.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // items
    uint blocks;
} params;

PAGED(0, readonly, uint, items);
PAGED(1, readonly, uint64_t, block_sums); // exclusive
PAGED(2, writeonly, uint, offsets);

shared uint sums[64];

// Inclusive sums over the workgroup (Hillis and Steele 1986), without subgroups of any size.
void scan_sums(uint lane) {
    for (uint width = 1u; width < 64u; width <<= 1) {
        uint value = lane >= width ? sums[lane - width] : 0u;
        barrier();
        sums[lane] += value;
        barrier();
    }
}

void main() {
    uint block = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
    if (block >= params.blocks) {
        return;
    }
    uint lane = gl_LocalInvocationID.x;
    uint first = block * ITEMS_PER_BLOCK + lane * ITEMS_PER_THREAD;
    uint end = min(first + ITEMS_PER_THREAD, params.count);
    uint sum = 0u;
    for (uint i = first; i < end; ++i) {
        sum += LOAD(items, i);
    }
    sums[lane] = sum;
    barrier();
    scan_sums(lane);
    uint before = uint(LOAD(block_sums, block)) + sums[lane] - sum;
    for (uint i = first; i < end; ++i) {
        STORE(offsets, i, before);
        before += LOAD(items, i);
    }
}
