#version 460
// Iterative parallax mapping with slopes (Premecz 2006): each turn goes on along the ray, towards the plane through the
// surface at the place reached, by (H - z) n_z for a direction of length 1 to the viewer. Where the surface rises towards
// the viewer that is too short, and never too far where it is level.
#include "march.glsl"
#include "parallax.glsl"

const uint TURNS = 4u;

// Height, and the square of its change for each texel.
vec2 height_and_slope(Trip trip, vec2 place) {
    vec2 corner = floor(place);
    vec4 h = corners_of(trip, ivec2(corner));
    vec2 f = place - corner;
    vec2 slope = vec2(mix(h.y - h.x, h.w - h.z, f.y), mix(h.z - h.x, h.w - h.y, f.x));
    return vec2(mix(mix(h.x, h.y, f.x), mix(h.z, h.w, f.x), f.y), dot(slope, slope));
}

March marched(Trip trip) {
    Base base = base_of(trip);
    float cosine = trip.course.cosine;
    // Texels for each unit of length across, squared: `slope` is those times the tangent.
    float texels_squared = dot(base.slope, base.slope) * cosine * cosine / max(1.0 - cosine * cosine, 1e-6);
    float z = base.place.z;
    [[dont_unroll]] for (uint k = 0u; k < TURNS; ++k) {
        vec2 found = height_and_slope(trip, base.place.xy + (z - base.place.z) * base.slope);
        z += (found.x - z) * inversesqrt(1.0 + found.y * texels_squared) * cosine;
    }
    return shifted(base, z, TURNS);
}

#include "march_pass.glsl"
