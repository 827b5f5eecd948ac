#version 460
// Parallax occlusion mapping (Brawley and Tatarchuk 2004, Tatarchuk 2006): even steps until the ray is below the
// surface, which counts as straight between the last two: w = g0 / (g0 - g1) of the step, g being the ray's gaps.
#include "march.glsl"
#include "march_search.glsl"

March marched(Trip trip) {
    uint steps = steps_of(trip);
    Crossing crossing = crossing_of(trip, steps);
    if (!crossing.found) {
        return nothing_met(crossing);
    }
    float stride = part_of(trip, steps) * float(PARTS);
    float w = crossing.above_gap / (crossing.above_gap - crossing.below_gap);
    return met_at(trip, (float(crossing.step - 1u) + w) * stride, crossing);
}

#include "march_pass.glsl"
