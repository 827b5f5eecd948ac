#version 460
// Selects the vertices whose candidate comes before those of all neighbours: by error, then by mixed keys, so that
// along a row not each waits for the next.
#include "common.glsl"
#include "pages.glsl"
#include "simplify.glsl"
#include "keys.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // vertices
    uint round;
} params;

PAGED(3, readonly, Candidate, candidates);
PAGED(4, readonly, uint, keys); // of vertices
PAGED(5, writeonly, uint, selected); // where it goes, or NOWHERE

Candidate candidate_of(const uint vertex) {
    return LOAD(candidates, vertex);
}

uint key_of(const uint vertex) {
    return mixed(LOAD(keys, vertex) ^ params.round);
}

bool comes_first(const uint vertex, const Candidate own, const uint other) {
    Candidate of_other = candidate_of(other);
    if (vertex == other || of_other.to == NOWHERE || own.error != of_other.error) {
        return vertex == other || of_other.to == NOWHERE || own.error < of_other.error;
    }
    uint a = key_of(vertex), b = key_of(other);
    return a < b || (a == b && vertex < other);
}

void element(uint i) {
    Candidate own = candidate_of(i);
    uint first = LOAD(star_first, i);
    uint count = LOAD(star_first, i + 1u) - first;
    bool wins = own.to != NOWHERE;
    for (uint k = 0u; k < min(count, MOST_AROUND) && wins; ++k) {
        uvec3 gv = facet_of(LOAD(star_items, first + k)).gv;
        wins = comes_first(i, own, gv.x) && comes_first(i, own, gv.y) && comes_first(i, own, gv.z);
    }
    STORE(selected, i, wins ? own.to : NOWHERE);
}

#include "batch.glsl"
