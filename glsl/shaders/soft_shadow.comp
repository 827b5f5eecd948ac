#version 460
// How much of a light arrives over the heights: by how far even steps towards it come below them, in shares of how far they
// have come up (Tatarchuk 2006). The share of light stands in the place of what else says where the surface is met.
#include "march.glsl"

// So many times as deep as it is far, and nothing arrives.
const float HARDNESS = 4.0;

March marched(Trip trip) {
    uint steps = steps_of(trip);
    float stride = float(trip.course.nodes - 1u) / float(steps);
    float from = place_at(trip, 0.0).z;
    float deepest = 0.0;
    [[dont_unroll]] for (uint k = 1u; k <= steps; ++k) {
        vec4 place = place_at(trip, float(k) * stride);
        deepest = max(deepest, (height_at(trip, place.xy) - place.z) / max(place.z - from, 1e-20));
    }
    return March(clamp(1.0 - HARDNESS * deepest, 0.0, 1.0), vec2(0.0), steps, steps, 0u);
}

#include "march_pass.glsl"
