#version 460
// Selects the vertices whose candidate comes before those of all neighbours: by error, then by mixed numbers, so that
// along a row not each waits for the next. Where only an estimate does, it is to be found out.
#include "common.glsl"
#include "pages.glsl"
#include "simplify.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // vertices
    uint round;
} params;

PAGED(3, readonly, Candidate, candidates);
PAGED(4, writeonly, uint, selected); // where it goes, or NOWHERE
PAGED(5, writeonly, uint, unsure);   // 0 or 1

Candidate candidate_of(const uint vertex) {
    return LOAD(candidates, vertex);
}

uint mixed(const uint vertex) {
    return (vertex ^ params.round * 0x85EBCA6Bu) * 0x9E3779B1u;
}

bool comes_first(const uint vertex, const Candidate own, const uint other) {
    Candidate of_other = candidate_of(other);
    return vertex == other || of_other.to == NOWHERE || own.error < of_other.error
        || (own.error == of_other.error && mixed(vertex) < mixed(other));
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
    STORE(selected, i, wins && own.to != UNSURE ? own.to : NOWHERE);
    STORE(unsure, i, wins && own.to == UNSURE ? 1u : 0u);
}

#include "batch.glsl"
