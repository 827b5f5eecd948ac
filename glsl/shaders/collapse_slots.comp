#version 460
// How many neighbours each listed vertex may try: one for each triangle around, on base edges both of its other vertices.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"
#include "simplify.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // of the list
    uint first; // the number of the first
} params;

PAGED(3, readonly, RefinedVertex, vertices);
PAGED(4, readonly, uint, list);
PAGED(5, writeonly, uint, slot_counts);

void element(uint i) {
    uint vertex = LOAD(list, params.first + i);
    uint around = LOAD(star_first, vertex + 1u) - LOAD(star_first, vertex);
    uint kind = LOAD(vertices, vertex).kind;
    bool stays = kind == CORNER || around > MOST_AROUND;
    STORE(slot_counts, i, stays ? 0u : (kind == EDGE ? 2u * around : around));
}

#include "batch.glsl"
