#version 460
// What any move of a listed vertex costs at least.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // of the list
    uint first; // the number of the first
} params;

PAGED(0, readonly, uint, list);
PAGED(1, readonly, uint, slot_counts);
PAGED(2, readonly, uint, slot_offsets);
PAGED(3, readonly, uint, move_to);
PAGED(4, readonly, float, move_errors);
PAGED(5, writeonly, Candidate, candidates);

void element(uint i) {
    uint first = LOAD(slot_offsets, i);
    uint count = LOAD(slot_counts, i);
    Candidate found = Candidate(NOWHERE, 0.0);
    for (uint k = 0u; k < count; ++k) {
        if (LOAD(move_to, first + k) != NOWHERE) {
            float error = LOAD(move_errors, first + k);
            found = found.to == NOWHERE || error < found.error ? Candidate(UNSURE, error) : found;
        }
    }
    STORE(candidates, LOAD(list, params.first + i), found);
}

#include "batch.glsl"
