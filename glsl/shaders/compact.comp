#version 460
// Keeps the flagged items: their numbers, in order.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // items
} params;

PAGED(0, readonly, uint, flags);   // 0 or 1
PAGED(1, readonly, uint, offsets); // exclusive sums of the flags
PAGED(2, writeonly, uint, kept);

void element(uint i) {
    if (LOAD(flags, i) != 0u) {
        STORE(kept, LOAD(offsets, i), i);
    }
}

#include "batch.glsl"
