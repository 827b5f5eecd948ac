#version 460
// The way from each fragment's place to a light, over the height map of its material up to the greatest height or to the
// light, as if the base went on flat across the normal that is interpolated there: so no edge is seen where facets meet. It
// stays within its chart: nothing beyond takes light. A thread per fragment. What lies below that horizon has no course, and
// a cosine below 0.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "surface_point.glsl"
#include "relief.glsl"
#include "light.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint uv_channels;
    uint light;
    uint has_outlines; // ways go on beyond charts
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, vec4, instance_rows);
PAGED(2, readonly, vec3, positions);
PAGED(3, readonly, vec3, normals);
PAGED(4, readonly, vec2, uvs);
PAGED(5, readonly, Relief, reliefs);
PAGED(6, readonly, ReliefLevel, relief_levels);
PAGED(7, readonly, float, texels);
PAGED(8, readonly, Light, lights);
PAGED(9, , Course, courses); // levels are there
PAGED(10, writeonly, vec4, course_nodes);
PAGED(11, readonly, uvec3, triangles);
PAGED(12, readonly, ChartSides, chart_sides);

#include "course_texels.glsl"
#include "course_plane.glsl"
#include "chart_walk.glsl"
#include "tiled.glsl"
#include "taps.glsl"
#include "relief_slope.glsl"

// A direction of the world in the mesh's space, of any length.
vec3 in_mesh(uint row, vec3 way) {
    vec3 x = LOAD(instance_rows, row + WORLD_ROW).xyz;
    vec3 y = LOAD(instance_rows, row + WORLD_ROW + 1u).xyz;
    vec3 z = LOAD(instance_rows, row + WORLD_ROW + 2u).xyz;
    vec3 across = cross(y, z);
    float volume = dot(x, across);
    return volume != 0.0 ? (way.x * across + way.y * cross(z, x) + way.z * cross(x, y)) / volume : vec3(0.0);
}

// Ends the course where its chart does, and bends it; `rise` is the height where it begins, how it changes, and where it
// is to end.
void clip(uint i, SurfacePoint point, Relief relief, uint level, vec3 rate, vec3 rise) {
    mat3x2 places = places_of(relief, point.vertices);
    Way way = way_from(point.triangle, places * point.at, places * rate);
    follow(relief, way, rise.z);
    vec2 size = vec2(LOAD(relief_levels, relief.level_first + level).size);
    uint node = i * COURSE_NODES;
    for (uint k = 0u; k < way.bends; ++k) {
        vec3 bend = way.bend[k];
        node += 1u;
        STORE(course_nodes, node, vec4(bend.xy * size - 0.5, rise.x + rise.y * bend.z, bend.z));
    }
    if (way.end != WAY_INSIDE || way.bends > 0u) {
        node += 1u;
        STORE(course_nodes, node, vec4(place_on(way, way.t) * size - 0.5, rise.x + rise.y * way.t, way.t));
        uint nodes = way.t > 0.0 ? node - i * COURSE_NODES + 1u : 0u;
        STORE(courses, i, Course(nodes, point.material, level, 1.0, 0u));
    }
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    uint level = LOAD(courses, i).level;
    if (relief.level_count == 0u || point.flip < 0.0) {
        STORE(courses, i, Course(0u, point.material, level, 0.0, 0u));
        return;
    }
    STORE(courses, i, Course(0u, point.material, level, -1.0, 0u));
    mat3 corner;
    vec3 normal = vec3(0.0);
    vec3 inside = max(point.at, vec3(0.0));
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(positions, point.vertices[k]);
        normal += LOAD(normals, point.vertices[k]) * inside[k];
    }
    float squared = dot(normal, normal);
    normal *= squared > 1e-30 && squared < 1e30 ? inversesqrt(squared) : 0.0;
    for (int k = 1; k < 3; ++k) {
        corner[k] -= normal * dot(normal, corner[k] - corner[0]);
    }
    Light light = LOAD(lights, params.light);
    bool is_sun = light.kind == LIGHT_SUN;
    vec3 way = in_mesh(point.instance * INSTANCE_ROWS, is_sun ? light.direction : light.position - point.position);
    Plane plane = plane_of(corner, normal);
    vec3 rate = in_plane(plane, normalize(way));
    if (plane.volume == 0.0 || !(rate.z > 0.0)) {
        return;
    }
    mat3x2 texel_corners = texels_of(relief, point.vertices, level);
    vec2 place = texel_corners * point.at;
    // A little above what is struck, so that a ray does not meet the facet it leaves.
    float low = height_at_place(relief, level, place) + (relief.high - relief.low) / 1024.0;
    float high = with_margin(plane, vec2(relief.low, relief.high)).y;
    float t = (high - low) / rate.z;
    if (!is_sun && length(way) < t) {
        t = length(way);
        high = low + rate.z * t;
    }
    vec2 gone = texel_corners * vec3(-rate.x - rate.y, rate.xy) * t;
    STORE(course_nodes, i * COURSE_NODES, vec4(place, low, 0.0));
    STORE(course_nodes, i * COURSE_NODES + 1u, vec4(place + gone, high, t));
    STORE(courses, i, Course(2u, point.material, level, 1.0, 0u));
    if (params.has_outlines == 0u) {
        clip(i, point, relief, level, vec3(-rate.x - rate.y, rate.xy), vec3(low, rate.z, t));
    }
}

#include "batch.glsl"
