#version 460
// The way of each fragment's ray over the height map of its material, as if the base went on flat around the fragment: between
// the greatest and the least height along the normal that is shaded there, and within the fragment's chart. A thread per
// fragment. Rays that do not go down have no course.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"
#include "relief.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform CourseFlatParams {
    uint count;
    uint uv_channels;
    uint finds_depth; // else ways go on beyond the chart: places alone are kept in it
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
PAGED(10, readonly, uvec3, triangles);
PAGED(11, readonly, ChartSides, chart_sides);

#include "pixel_ray.glsl"
#include "course_texels.glsl"
#include "course_plane.glsl"
#include "chart_walk.glsl"
#include "chart_foot.glsl"

// Place on the level, height, and t along the ray, of a place and t of a way.
vec4 node_on(Foot foot, vec2 size, float sense, vec3 place) {
    return vec4(place.xy * size - 0.5, foot.rise * sense * place.z, foot.t + sense * place.z);
}

vec3 last_on(Way way) {
    return vec3(place_on(way, way.t), way.t);
}

// Between two t, as far as the ray is over the chart from the foot on. Where the foot is beyond one of them, the way leads
// there first.
Course bordered(uint first, Foot foot, SurfacePoint point, Relief relief, vec2 range, uint level) {
    vec2 size = vec2(LOAD(relief_levels, relief.level_first + level).size);
    Way back = way_of(foot, point.triangle, -1.0);
    Way forth = way_of(foot, point.triangle, 1.0);
    vec2 ts = range - foot.t;
    if (ts.y < 0.0) {
        follow(relief, back, -ts.y);
    }
    if (ts.x > 0.0) {
        follow(relief, forth, ts.x);
    }
    vec4 last = node_on(foot, size, -1.0, last_on(back));
    vec4 next = node_on(foot, size, 1.0, last_on(forth));
    if (back.end == WAY_OPEN || back.end == WAY_SEAM || forth.end == WAY_OPEN || forth.end == WAY_SEAM) {
        STORE(course_nodes, first, back.t > 0.0 ? last : next);
        return Course(1u, point.material, level, 0.0, (back.end & 3u) | (forth.end & 3u) << 4);
    }
    back.bends = 0u;
    forth.bends = 0u;
    if (!(ts.x > 0.0)) {
        follow(relief, back, -ts.x);
        next = node_on(foot, size, -1.0, last_on(back));
    }
    if (!(ts.y < 0.0)) {
        follow(relief, forth, ts.y);
        last = node_on(foot, size, 1.0, last_on(forth));
    }
    uint node = first;
    STORE(course_nodes, node, next);
    for (uint k = 0u; k < back.bends; ++k) {
        node += 1u;
        STORE(course_nodes, node, node_on(foot, size, -1.0, back.bend[back.bends - 1u - k]));
    }
    for (uint k = 0u; k < forth.bends; ++k) {
        node += 1u;
        STORE(course_nodes, node, node_on(foot, size, 1.0, forth.bend[k]));
    }
    if (next.z > last.z) {
        node += 1u;
        STORE(course_nodes, node, last);
    }
    return Course(node - first + 1u, point.material, level, 0.0, (back.end & 3u) | (forth.end & 3u) << 4);
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    uint level = LOAD(courses, i).level;
    STORE(courses, i, Course(0u, point.material, level, 0.0, 0u));
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
    uint first_node = i * COURSE_NODES;
    float cosine = abs(dot(ray.direction, plane.normal));
    if (params.finds_depth != 0u) {
        mat3x2 places = places_of(relief, point.vertices);
        Foot foot = Foot(places * point.at, places * vec3(-rate.x - rate.y, rate.xy), -from.z / rate.z, rate.z);
        Course course = bordered(first_node, foot, point, relief, vec2(first, last), level);
        course.cosine = cosine;
        STORE(course_nodes, first_node + COURSE_NODES - 1u, vec4(foot.rate, foot.t, foot.rise)); // for `land`
        STORE(courses, i, course);
        return;
    }
    mat3x2 texels = texels_of(relief, point.vertices, level);
    vec3 start = from + rate * first;
    vec3 end = from + rate * last;
    STORE(course_nodes, first_node, vec4(texels * weights_of(start), start.z, first));
    STORE(course_nodes, first_node + 1u, vec4(texels * weights_of(end), end.z, last));
    STORE(courses, i, Course(2u, point.material, level, cosine, 0u));
}

#include "batch.glsl"
