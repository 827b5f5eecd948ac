#version 460
// Takes from what arrives of a light what relief keeps off: a thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "relief.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint lights;
    uint light;
    uint soft; // marches hold shares of light; else whether its way is met
} params;

PAGED(0, readonly, Course, courses);
PAGED(1, readonly, March, marches);
PAGED(2, , float, shadows); // as `arriving_of` reads it

float share_of(Course course, March march) {
    if (course.nodes < 2u) {
        return course.cosine < 0.0 ? 0.0 : 1.0;
    }
    return params.soft != 0u ? march.s : (march.s < 0.0 ? 1.0 : 0.0);
}

void element(uint i) {
    float share = share_of(LOAD(courses, i), LOAD(marches, i));
    uint place = i * params.lights + params.light;
    float stored = LOAD(shadows, place);
    if (stored < 0.0) {
        // Of a light's samples as many as the share is of all.
        uint kept = (1u << uint(round(share * 16.0))) - 1u;
        STORE(shadows, place, -1.0 - float(uint(-1.0 - stored) & kept));
    } else {
        STORE(shadows, place, stored * share);
    }
}

#include "batch.glsl"
