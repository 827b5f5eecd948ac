// What every method that marches is bound to: include first, then define
//   March marched(Trip trip)
// and include march_pass.glsl. A ray meets the surface where it goes from above it to on or below it; one that starts
// below is let out first.
#include "common.glsl"
#include "pages.glsl"
#include "relief.glsl"
#include "tiled.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform MarchParams {
    uint count;    // courses
    float setting; // what it means is the method's own
} params;

PAGED(0, readonly, Relief, reliefs); // of materials
PAGED(1, readonly, ReliefLevel, relief_levels);
PAGED(2, readonly, float, texels);
PAGED(3, readonly, Course, courses);
PAGED(4, readonly, vec4, course_nodes);
PAGED(5, writeonly, March, marches);

// A course and what it leads over.
struct Trip {
    Relief relief;
    ReliefLevel level;
    Course course;
    uint node_first; // into `course_nodes`
};

vec4 node_of(Trip trip, uint k) {
    return LOAD(course_nodes, trip.node_first + k);
}

// The course at s, from 0 to nodes - 1.
vec4 place_at(Trip trip, float s) {
    uint k = min(uint(max(s, 0.0)), trip.course.nodes - 2u);
    return mix(node_of(trip, k), node_of(trip, k + 1u), s - float(k));
}

// How many texels the course leads over.
float travel_of(Trip trip) {
    float travel = 0.0;
    [[dont_unroll]] for (uint k = 0u; k + 1u < min(trip.course.nodes, COURSE_NODES); ++k) {
        travel += length(node_of(trip, k + 1u).xy - node_of(trip, k).xy);
    }
    return travel;
}

const uint LEAST_STEPS = 8u;
const uint MOST_STEPS = 512u;

// So many that none is longer than the thinnest feature, unless the material says how many.
uint steps_of(Trip trip) {
    if (trip.relief.steps != 0u) {
        return min(trip.relief.steps, MOST_STEPS);
    }
    float thinnest = max(trip.relief.thinnest_texels * exp2(-float(trip.course.level)), 1.0);
    return uint(clamp(ceil(travel_of(trip) / thinnest), float(LEAST_STEPS), float(MOST_STEPS)));
}

float height_of(Trip trip, ivec2 texel) {
    ivec2 size = ivec2(trip.level.size);
    int x = tiled(texel.x, size.x, trip.relief.wrap & 3u);
    int y = tiled(texel.y, size.y, trip.relief.wrap >> 2);
    uint at = trip.level.height_first + uint(y * size.x + x);
    return LOAD_TEXEL(at);
}

// The four corners of a cell: (0, 0), (1, 0), (0, 1), (1, 1).
vec4 corners_of(Trip trip, ivec2 cell) {
    return vec4(
        height_of(trip, cell), height_of(trip, cell + ivec2(1, 0)), height_of(trip, cell + ivec2(0, 1)),
        height_of(trip, cell + ivec2(1, 1)));
}

// The height at a place: one fetch.
float height_at(Trip trip, vec2 place) {
    vec2 corner = floor(place);
    vec4 h = corners_of(trip, ivec2(corner));
    vec2 f = place - corner;
    return mix(mix(h.x, h.y, f.x), mix(h.z, h.w, f.x), f.y);
}
