#version 460
// The move of each listed vertex that costs least, of equal ones the one to the vertex with the lowest key.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;      // of the list
    uint first;      // the number of the first
    float tolerance; // local units
} params;

PAGED(0, readonly, uint, list);
PAGED(1, readonly, uint, slot_counts);
PAGED(2, readonly, uint, slot_offsets);
PAGED(3, readonly, uint, move_to);
PAGED(4, readonly, uint, move_counts);
PAGED(5, readonly, uint, move_offsets);
PAGED(6, readonly, float, bounds); // of the triangles that change
PAGED(7, readonly, uint, keys); // of vertices
PAGED(8, writeonly, Candidate, candidates);

float worst_of(const uint slot) {
    uint first = LOAD(move_offsets, slot);
    uint count = LOAD(move_counts, slot);
    float worst = 0.0;
    for (uint k = 0u; k < count && worst <= params.tolerance; ++k) {
        worst = max(worst, LOAD(bounds, first + k));
    }
    return worst;
}

bool is_better(const uint to, const float error, const Candidate best) {
    if (error != best.error || best.to == NOWHERE) {
        return error < best.error || (error == best.error && best.to == NOWHERE);
    }
    uint a = LOAD(keys, to), b = LOAD(keys, best.to);
    return a < b || (a == b && to < best.to);
}

void element(uint i) {
    uint first = LOAD(slot_offsets, i);
    uint count = LOAD(slot_counts, i);
    Candidate best = Candidate(NOWHERE, params.tolerance);
    for (uint k = 0u; k < count; ++k) {
        uint to = LOAD(move_to, first + k);
        if (to == NOWHERE) {
            continue;
        }
        float error = worst_of(first + k);
        if (is_better(to, error, best)) {
            best = Candidate(to, error);
        }
    }
    STORE(candidates, LOAD(list, params.first + i), best);
}

#include "batch.glsl"
