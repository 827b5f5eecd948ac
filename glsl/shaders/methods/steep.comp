#version 460
// Steep parallax mapping (McGuire and McGuire 2005): even steps along the ray until it is below the surface; where it is
// then counts as the surface, so that the picture has a stair for each step.
#include "march.glsl"

March marched(Trip trip) {
    uint steps = steps_of(trip);
    float stride = float(trip.course.nodes - 1u) / float(steps);
    bool above = false;
    March march = March(MISSED, vec2(0.0), 0u, 0u, 0u);
    [[dont_unroll]] for (uint k = 0u; k <= steps; ++k) {
        float s = float(k) * stride;
        vec4 place = place_at(trip, s);
        float gap = place.z - height_at(trip, place.xy);
        march.fetches += 1u;
        march.steps = k;
        if (above && gap <= 0.0) {
            march.s = s;
            march.place = place.xy;
            break;
        }
        above = above || gap > 0.0;
    }
    return march;
}

#include "march_pass.glsl"
