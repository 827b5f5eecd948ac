#version 460
// Where each ray has met its height map, or the border of its chart, and the triangle that lies there, to which the fragment's
// point is moved. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"
#include "relief.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform RelieveParams {
    uint count;
    uint uv_channels;
    uint finds_depth;  // else maps are shifted, and nothing else
    uint has_outlines; // charts have no borders
    uint tests;        // fragments are samples under test: what is missed is not seen
    uint lifts;        // relieve alone asks
} params;

PAGED(0, readonly, Fragment, fragments);
PAGED(1, , SurfacePoint, points);
PAGED(2, readonly, vec4, instance_rows);
PAGED(3, readonly, vec3, positions);
PAGED(4, readonly, vec2, uvs);
PAGED(5, readonly, Relief, reliefs);
PAGED(6, readonly, ReliefLevel, relief_levels);
PAGED(7, readonly, float, texels);
PAGED(8, readonly, Course, courses);
PAGED(9, readonly, vec4, course_nodes);
PAGED(10, readonly, March, marches);
PAGED(11, readonly, uvec3, triangles);
PAGED(12, readonly, ChartSides, chart_sides);
PAGED(13, writeonly, Landing, landings);

#include "pixel_ray.glsl"
#include "tiled.glsl"
#include "taps.glsl"
#include "relief_slope.glsl"
#include "chart_walk.glsl"
#include "chart_foot.glsl"
#include "chart_met.glsl"

vec4 node_at(uint first, uint nodes, float s) {
    uint k = min(uint(max(s, 0.0)), nodes - 2u);
    return mix(LOAD(course_nodes, first + k), LOAD(course_nodes, first + k + 1u), s - float(k));
}

Met met_on(Relief relief, Course course, uint i) {
    March march = LOAD(marches, i);
    if (course.nodes < 2u || march.s < 0.0) {
        return Met(false, false, 0.0, march.place, 0.0);
    }
    vec4 node = node_at(i * COURSE_NODES, course.nodes, march.s);
    float high = height_at_place(relief, course.level, march.place);
    // Lights may see a finer level.
    if (course.level > 0u) {
        vec2 finer = vec2(LOAD(relief_levels, relief.level_first).size)
            / vec2(LOAD(relief_levels, relief.level_first + course.level).size);
        high = max(high, height_at_place(relief, 0u, (march.place + 0.5) * finer - 0.5));
    }
    return Met(true, false, node.w, march.place, max(high - node.z, 0.0));
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    Course course = LOAD(courses, i);
    if (relief.level_count == 0u || course.nodes == 0u) {
        STORE(landings, i, Landing(vec3(0.0), vec2(0.0), vec2(0.0), LANDED_NOWHERE, 0.0));
        return;
    }
    Met met = met_on(relief, course, i);
    vec3 corner = LOAD(positions, point.vertices[0]);
    PixelRay ray = pixel_ray(point.instance * INSTANCE_ROWS, LOAD(fragments, i).at_px, corner);
    vec2 turns = vec2(0.0);
    if (params.has_outlines == 0u) {
        vec2 size = vec2(LOAD(relief_levels, relief.level_first + course.level).size);
        // Behind the nodes, which are at most two ends and twice MOST_BENDS.
        vec4 kept = LOAD(course_nodes, (i + 1u) * COURSE_NODES - 1u);
        Foot foot = Foot(places_of(relief, point.vertices) * point.at, kept.xy, kept.z, kept.w);
        met = met_at_border(relief, course, i * COURSE_NODES, -1.0 / foot.rise, met);
        if (met.found) {
            turns = moved(point, relief, foot, size, met);
            STORE(points, i, point);
        }
    }
    uint kind = met.found ? (met.is_level ? LANDED_LEVEL : LANDED) : LANDED_NOWHERE;
    STORE(landings, i, Landing(corner + ray.origin + met.t * ray.direction, met.place, turns, kind, met.lift));
}

#include "batch.glsl"
