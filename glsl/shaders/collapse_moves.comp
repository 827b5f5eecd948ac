#version 460
// Finds out of each neighbour of listed vertices whether the vertex may go there at all: along its base edge, with as many
// triangles vanishing as there are sheets, none turning over, and within the tolerance at the place it leaves.
#include "common.glsl"
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "pages.glsl"
#include "refine.glsl"
#include "simplify.glsl"
#include "judge.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;      // slots
    uint first;      // the number of the first vertex in the list
    float tolerance; // local units
} params;

PAGED(7, readonly, Sheets, sheets); // of base ges
PAGED(8, readonly, uint, list);
PAGED(9, readonly, uvec2, slots);         // listed vertex less `first`, and which of its slots
PAGED(10, writeonly, uint, move_to);      // or NOWHERE
PAGED(11, writeonly, uint, move_counts);  // triangles that change
PAGED(12, writeonly, float, move_errors); // no less, local units

const float TOO_MUCH = 1e30;

struct Star {
    uint vertex;
    uint first;
    uint count;
};

Facet facet_around(const Star star, const uint k) {
    return facet_of(LOAD(star_items, star.first + k));
}

// The neighbour that a slot stands for.
uint neighbour(const Star star, const uint slot) {
    bool back = slot >= star.count;
    uvec3 gv = facet_around(star, back ? slot - star.count : slot).gv;
    uvec3 after = back ? gv.zxy : gv.yzx;
    return gv.x == star.vertex ? after.x : (gv.y == star.vertex ? after.y : after.z);
}

// Whether the vertex may go along its base edge to another: neither moves off it.
bool is_along(const RefinedVertex moving, const RefinedVertex target) {
    if (target.kind == EDGE) {
        return target.owner == moving.owner;
    }
    return target.kind == CORNER && any(equal(LOAD(sheets, moving.owner).gv, uvec2(target.owner)));
}

// How far the place that the vertex leaves is from a new triangle that lies over it: most that fail, fail there.
float lost(const uint vertex, const uvec3 left, const Facet after, const uvec3 a, const uvec3 b, const uvec3 c) {
    int64_t over_a = twice_area(left, b, c), over_b = twice_area(a, left, c), over_c = twice_area(a, b, left);
    if (over_a < 0l || over_b < 0l || over_c < 0l) {
        return 0.0;
    }
    vec3 shares = vec3(over_a, over_b, over_c) / float(over_a + over_b + over_c);
    vec3 flat_place = position_of(after.gv.x) * shares.x + position_of(after.gv.y) * shares.y
        + position_of(after.gv.z) * shares.z;
    return distance(flat_place, position_of(vertex));
}

// What is lost by a triangle's change, or TOO_MUCH.
float change(const uint vertex, const Facet before, const Facet after) {
    RefineBase base = base_of(after.base);
    uvec3 a = barycentrics(vertex_of(after.gv.x), base);
    uvec3 b = barycentrics(vertex_of(after.gv.y), base);
    uvec3 c = barycentrics(vertex_of(after.gv.z), base);
    if (twice_area(a, b, c) <= 0l || !faces_as(before, after)) {
        return TOO_MUCH;
    }
    return lost(vertex, barycentrics(vertex_of(vertex), base), after, a, b, c);
}

// How many triangles vanish; none where the vertex may not go.
uint vanishing(const Star star, const uint slot, const uint to) {
    RefinedVertex moving = vertex_of(star.vertex);
    bool on_edge = moving.kind == EDGE;
    if (on_edge && !is_along(moving, vertex_of(to))) {
        return 0u;
    }
    uint own = slot >= star.count ? slot - star.count : slot;
    uint vanish = 0u;
    for (uint k = 0u; k < star.count; ++k) {
        bool vanishes = has(facet_around(star, k), to);
        // On an edge a neighbour stands in several slots: the first counts.
        if (vanishes && on_edge && k < own) {
            return 0u;
        }
        vanish += vanishes ? 1u : 0u;
    }
    return vanish == (on_edge ? LOAD(sheets, moving.owner).count : 2u) ? vanish : 0u;
}

// What is lost by going there.
float least(const Star star, const uint to) {
    float most = 0.0;
    [[dont_unroll]] for (uint k = 0u; k < star.count && most <= params.tolerance; ++k) {
        Facet facet = facet_around(star, k);
        if (!has(facet, to)) {
            most = max(most, change(star.vertex, facet, moved(facet, star.vertex, to)));
        }
    }
    return most;
}

void element(uint i) {
    uvec2 slot = LOAD(slots, i);
    uint vertex = LOAD(list, params.first + slot.x);
    uint first = LOAD(star_first, vertex);
    Star star = Star(vertex, first, min(LOAD(star_first, vertex + 1u) - first, MOST_AROUND));
    uint to = neighbour(star, slot.y);
    uint vanish = vanishing(star, slot.y, to);
    float error = vanish > 0u ? least(star, to) : TOO_MUCH;
    bool goes = error <= params.tolerance;
    STORE(move_to, i, goes ? to : NOWHERE);
    STORE(move_counts, i, goes ? star.count - vanish : 0u);
    STORE(move_errors, i, error);
}

#include "batch.glsl"
