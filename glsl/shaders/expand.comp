#version 460
// Gives every item as many places as it counts: each place finds its item, and its number among the item's places.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // places
    uint items; // at least 1
} params;

PAGED(0, readonly, uint, offsets); // exclusive sums of the counts
PAGED(1, writeonly, uvec2, places); // item, number in it

// The last item whose places begin at or before `place`: items without places are skipped.
uint item_of(uint place) {
    uint low = 0u;
    uint high = params.items - 1u;
    for (uint k = 0u; k < 32u && low < high; ++k) {
        uint middle = low + (high - low + 1u) / 2u;
        if (LOAD(offsets, middle) <= place) {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    return low;
}

void element(uint i) {
    uint item = item_of(i);
    STORE(places, i, uvec2(item, i - LOAD(offsets, item)));
}

#include "batch.glsl"
