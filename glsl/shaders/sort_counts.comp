#version 460
// Radix sort, first of two passes a digit: how many records of each block have each digit.
#include "common.glsl"
#include "pages.glsl"
#include "scan_block.glsl"
#include "sort_block.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // records
    uint blocks;
    uint shift; // bits below the digit
} params;

PAGED(0, readonly, uvec2, records); // key, value
PAGED(1, writeonly, uint, counts);  // by digit, then by block

void main() {
    uint block = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
    if (block >= params.blocks) {
        return;
    }
    uint lane = gl_LocalInvocationID.x;
    [[dont_unroll]] for (uint digit = 0u; digit < DIGITS; ++digit) {
        histogram[digit * 64u + lane] = 0u;
    }
    uint first = block * ITEMS_PER_BLOCK + lane * ITEMS_PER_THREAD;
    uint end = min(first + ITEMS_PER_THREAD, params.count);
    for (uint i = first; i < end; ++i) {
        histogram[digit_of(LOAD(records, i).x, params.shift) * 64u + lane] += 1u;
    }
    barrier();
    if (lane < DIGITS) {
        uint sum = 0u;
        [[dont_unroll]] for (uint k = 0u; k < 64u; ++k) {
            sum += histogram[lane * 64u + k];
        }
        STORE(counts, lane * params.blocks + block, sum);
    }
}
