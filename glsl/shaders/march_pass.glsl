// Marches every course by `marched`; see march.glsl. Include last. A thread per course.

void element(uint i) {
    Trip trip;
    trip.course = LOAD(courses, i);
    trip.node_first = i * COURSE_NODES;
    if (trip.course.nodes < 2u) {
        STORE(marches, i, March(MISSED, vec2(0.0), 0u, 0u, 0u));
        return;
    }
    trip.relief = LOAD(reliefs, trip.course.material);
    trip.level = LOAD(relief_levels, trip.relief.level_first + trip.course.level);
    STORE(marches, i, marched(trip));
}

#include "batch.glsl"
