#version 460
// Radix sort, second of two passes a digit: every record goes behind all with smaller digits and behind those with
// the same digit that come before it.
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
PAGED(1, readonly, uint, offsets);  // exclusive sums of the counts
PAGED(2, writeonly, uvec2, sorted);

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
    // Counts become the places where each thread's records of a digit begin.
    if (lane < DIGITS) {
        uint before = LOAD(offsets, lane * params.blocks + block);
        [[dont_unroll]] for (uint k = 0u; k < 64u; ++k) {
            uint own = histogram[lane * 64u + k];
            histogram[lane * 64u + k] = before;
            before += own;
        }
    }
    barrier();
    for (uint i = first; i < end; ++i) {
        uvec2 record = LOAD(records, i);
        uint slot = digit_of(record.x, params.shift) * 64u + lane;
        STORE(sorted, histogram[slot], record);
        histogram[slot] += 1u;
    }
}
