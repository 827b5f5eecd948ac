#version 460
// Relief mapping (Policarpo, Oliveira and Comba 2005): even steps until the ray is below the surface, then five
// bisections of the last one. What is found is at most 1/32 of a step behind where the ray goes below.
#include "march.glsl"
#include "march_search.glsl"

March marched(Trip trip) {
    uint steps = steps_of(trip);
    Crossing crossing = crossing_of(trip, steps);
    if (!crossing.found) {
        return nothing_met(crossing);
    }
    uint below = crossing.step * PARTS;
    March march = March(0.0, vec2(0.0), crossing.step + 1u, crossing.step, 0u);
    return bisected(trip, part_of(trip, steps), below - PARTS, below, march);
}

#include "march_pass.glsl"
