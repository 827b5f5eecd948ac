#version 460
// The way of each fragment's ray through the prism over its triangle, over the material's height map. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"
#include "relief.glsl"
#include "geometry_shell.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform CourseParams {
    uint count;
    uint uv_channels;
} params;

PAGED(0, readonly, Fragment, fragments);
PAGED(1, readonly, SurfacePoint, points);
PAGED(2, readonly, vec4, instance_rows);
PAGED(3, readonly, vec3, positions);
PAGED(4, readonly, vec3, directions);
PAGED(5, readonly, vec2, uvs);
PAGED(6, readonly, Relief, reliefs);
PAGED(7, readonly, ReliefLevel, relief_levels);
PAGED(8, , Course, courses); // levels are there
PAGED(9, writeonly, vec4, course_nodes);

#include "pixel_ray.glsl"
#include "course_texels.glsl"

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    uint level = LOAD(courses, i).level;
    STORE(courses, i, Course(0u, point.material, level, 0.0, 0u));
    if (relief.level_count == 0u) {
        return;
    }
    mat3 corner;
    mat3 along;
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(positions, point.vertices[k]);
        along[k] = LOAD(directions, point.vertices[k]);
    }
    mat3x2 texels = texels_of(relief, point.vertices, level);
    Prism prism = prism_of(corner, along, vec2(relief.low, relief.high));
    if (prism.side <= 0.0) {
        return;
    }
    PixelRay ray = pixel_ray(point.instance * INSTANCE_ROWS, LOAD(fragments, i).at_px, corner[0]);
    vec3 origin = ray.origin / prism.side;
    vec3 direction = ray.direction / prism.side;
    vec2 range = prism_range(prism, origin, direction);
    range.x = max(range.x, ray.least);
    if (range.x >= range.y) {
        return;
    }
    Under under = guess_under(prism, origin + direction * range.x);
    bool found = true;
    [[dont_unroll]] for (uint n = 0u; n < COURSE_NODES; ++n) {
        float t = mix(range.x, range.y, float(n) / float(COURSE_NODES - 1u));
        under = place_under(prism, origin + direction * t, under);
        found = found && under.found;
        STORE(course_nodes, i * COURSE_NODES + n, vec4(texels * under.weights, height_of_place(prism, under), t));
    }
    if (found) {
        STORE(courses, i, Course(COURSE_NODES, point.material, level, abs(dot(ray.direction, prism.upright)), 0u));
    }
}

#include "batch.glsl"
