#version 460
// The way of each fragment's ray over the height map of its material, as if the base went on flat around the fragment: between
// the greatest and the least height along the normal that is shaded there. A thread per fragment. Rays that do not go down
// have no course.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"
#include "relief.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform CourseParams {
    uint count;
    uint uv_channels;
} params;

PAGED(0, readonly, Fragment, fragments);
PAGED(1, readonly, SurfacePoint, points);
PAGED(2, readonly, vec4, instance_rows);
PAGED(3, readonly, vec3, positions);
PAGED(4, readonly, vec3, normals);
PAGED(5, readonly, vec2, uvs);
PAGED(6, readonly, Relief, reliefs);
PAGED(7, readonly, ReliefLevel, relief_levels);
PAGED(8, , Course, courses); // levels are there
PAGED(9, writeonly, vec4, course_nodes);

#include "pixel_ray.glsl"
#include "course_texels.glsl"
#include "course_plane.glsl"

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    uint level = LOAD(courses, i).level;
    STORE(courses, i, Course(0u, point.material, level, 0.0));
    if (relief.level_count == 0u || point.flip < 0.0) {
        return;
    }
    mat3 corner;
    vec3 normal = vec3(0.0);
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(positions, point.vertices[k]);
        normal += LOAD(normals, point.vertices[k]) * point.at[k];
    }
    PixelRay ray = pixel_ray(point.instance * INSTANCE_ROWS, LOAD(fragments, i).at_px, corner[0]);
    Plane plane = plane_of(corner, normal);
    vec3 from = in_plane(plane, ray.origin);
    vec3 rate = in_plane(plane, ray.direction);
    if (plane.volume == 0.0 || rate.z >= 0.0) {
        return;
    }
    vec2 heights = with_margin(plane, vec2(relief.low, relief.high));
    float first = max((heights.y - from.z) / rate.z, ray.least);
    float last = (heights.x - from.z) / rate.z;
    // What an f32 and a loop can follow.
    if (!(last > first) || !(last - first < 1e18 * plane.side)) {
        return;
    }
    mat3x2 texels = texels_of(relief, point.vertices, level);
    vec3 start = from + rate * first;
    vec3 end = from + rate * last;
    STORE(course_nodes, i * COURSE_NODES, vec4(texels * weights_of(start), start.z, first));
    STORE(course_nodes, i * COURSE_NODES + 1u, vec4(texels * weights_of(end), end.z, last));
    STORE(courses, i, Course(2u, point.material, level, abs(dot(ray.direction, plane.normal))));
}

#include "batch.glsl"
