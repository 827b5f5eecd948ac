#version 460
// Finds the sides of triangles that may be turned: those between two triangles of one base triangle, each listed by the
// one with the lower number.
#include "common.glsl"
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "pages.glsl"
#include "refine.glsl"
#include "simplify.glsl"
#include "judge.glsl"
#include "flip.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;      // sides: three of each triangle
    float tolerance; // local units
} params;

PAGED(7, readonly, float, errors); // of triangles, local units
PAGED(8, writeonly, Flip, flips);
PAGED(9, writeonly, uint, flip_counts); // triangles that come of it: 2 or 0

// The one other triangle at side ab.
uint across(const uint t, const uint a, const uint b) {
    uint first = LOAD(star_first, a);
    uint count = LOAD(star_first, a + 1u) - first;
    uint found = NOWHERE;
    for (uint k = 0u; k < count; ++k) {
        uint other = LOAD(star_items, first + k);
        if (other != t && has(facet_of(other), b)) {
            if (found != NOWHERE) {
                return NOWHERE;
            }
            found = other;
        }
    }
    return found;
}

bool is_upright(const uvec3 gv, const RefineBase base) {
    uvec3 a = barycentrics(vertex_of(gv.x), base);
    uvec3 b = barycentrics(vertex_of(gv.y), base);
    uvec3 c = barycentrics(vertex_of(gv.z), base);
    return twice_area(a, b, c) > 0l;
}

// Whether both triangles that come of it are sound, as seen from both that were.
bool is_sound(const Facet own, const Facet other, const uvec3 abc, const uint d) {
    RefineBase base = base_of(own.base);
    for (uint k = 0u; k < 2u; ++k) {
        Facet after = Facet(k == 0u ? first_after(abc, d) : second_after(abc, d), own.base);
        if (!is_upright(after.gv, base) || !faces_as(own, after) || !faces_as(other, after)) {
            return false;
        }
    }
    return true;
}

Flip flip_of(const uint t, const uint side) {
    const Flip none = Flip(NOWHERE, 0u);
    Facet own = facet_of(t);
    uvec3 abc = turned(own.gv, side);
    uint number = across(t, abc.x, abc.y);
    if (number == NOWHERE || number < t) {
        return none;
    }
    Facet other = facet_of(number);
    float before = max(LOAD(errors, t), LOAD(errors, number));
    if (other.base != own.base || before <= LEAST_GAIN * params.tolerance) {
        return none;
    }
    uvec3 left = other.gv;
    uint d = left.x != abc.x && left.x != abc.y ? left.x : (left.y != abc.x && left.y != abc.y ? left.y : left.z);
    return is_sound(own, other, abc, d) ? Flip(number, d) : none;
}

void element(uint i) {
    uint t = i / 3u;
    Flip flip = flip_of(t, i - 3u * t);
    STORE(flips, i, flip);
    STORE(flip_counts, i, flip.other == NOWHERE ? 0u : 2u);
}

#include "batch.glsl"
