#version 460
// Steep parallax mapping (McGuire and McGuire 2005): even steps along the ray until it is below the surface; where it is
// then counts as the surface, so that the picture has a stair for each step.
#include "march.glsl"
#include "march_search.glsl"

March marched(Trip trip) {
    uint steps = steps_of(trip);
    Crossing crossing = crossing_of(trip, steps);
    if (!crossing.found) {
        return nothing_met(crossing);
    }
    return met_at(trip, float(crossing.step * PARTS) * part_of(trip, steps), crossing);
}

#include "march_pass.glsl"
