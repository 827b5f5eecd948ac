#version 460
// Parallax mapping with offset limiting (Welsh 2004): the shift of parallax mapping times the cosine of the angle, so
// that it is never longer than the height.
#include "march.glsl"
#include "parallax.glsl"

March marched(Trip trip) {
    Base base = base_of(trip);
    base.slope *= trip.course.cosine;
    return shifted(base, height_at(trip, base.place.xy), 1u);
}

#include "march_pass.glsl"
