#version 460
// Parallax mapping (Kaneko et al. 2001): the surface counts as level, at the height that it has where the ray meets the
// base. What is shown is off by at most how much the heights change over the shift, and the shift has no bound.
#include "march.glsl"
#include "parallax.glsl"

March marched(Trip trip) {
    Base base = base_of(trip);
    return shifted(base, height_at(trip, base.place.xy), 1u);
}

#include "march_pass.glsl"
