#version 460
// Normals of what relief has struck, where it is seen larger than it is on the map: those that a displaced surface has there,
// in place of slopes that are filtered. In between both are blended. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "surface_point.glsl"
#include "material.glsl"
#include "appearance.glsl"
#include "relief.glsl"
#include "bump.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform CourseParams {
    uint count;
    uint uv_channels;
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, vec2, uvs);
PAGED(2, readonly, Relief, reliefs);
PAGED(3, readonly, ReliefLevel, relief_levels);
PAGED(4, readonly, Course, courses);
PAGED(5, readonly, Landing, landings);
PAGED(6, readonly, Bump, bumps);
PAGED(7, , Appearance, appearances);
PAGED(8, readonly, vec3, positions);
PAGED(9, readonly, vec4, instance_rows);
PAGED(10, readonly, float, texels);

#include "course_texels.glsl"
#include "tiled.glsl"
#include "taps.glsl"
#include "relief_slope.glsl"
#include "world.glsl"

// World.
vec3 struck_normal(SurfacePoint point, mat3x2 corners, vec2 slope) {
    uint row = point.instance * INSTANCE_ROWS;
    vec3 n = vec3(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        n += LOAD(instance_rows, row + WORLD_ROW + k).xyz * point.normal[k];
    }
    n = unit_or_zero(n);
    vec3 first = LOAD(positions, point.vertices[0]);
    vec3 side_1 = LOAD(positions, point.vertices[1]) - first;
    vec3 side_2 = LOAD(positions, point.vertices[2]) - first;
    vec2 rises = slope * mat2(corners[1] - corners[0], corners[2] - corners[0]);
    return unit_or_zero(mapped(row + NORMAL_ROW, vec4(n - surface_gradient(side_1, side_2, n, rises), 0.0)));
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    if (relief.level_count == 0u || LOAD(landings, i).kind == LANDED_NOWHERE) {
        return;
    }
    // A normal map says more than the heights do.
    bool has_map = (LOAD(appearances, i).flags & MATERIAL_NORMAL_MAP) != 0u;
    if (has_map || !any(equal(LOAD(bumps, point.material).kinds, uvec4(BUMP_HEIGHT)))) {
        return;
    }
    // Of the finest level: of what is coarser filtered slopes tell.
    mat3x2 corners = texels_of(relief, point.vertices, 0u);
    vec2 dx = corners * point.at_dx;
    vec2 dy = corners * point.at_dy;
    float share = clamp(2.0 - sqrt(abs(dx.x * dy.y - dx.y * dy.x)), 0.0, 1.0);
    uint level = LOAD(courses, i).level;
    vec2 slope = smooth_slope_at(relief, level, LOAD(landings, i).place);
    vec3 struck = struck_normal(point, texels_of(relief, point.vertices, level), slope);
    vec3 normal = mix(LOAD(appearances, i).normal, struck, share);
    float squared = dot(normal, normal);
    if (squared > 1e-12) {
        LOAD(appearances, i).normal = normal * inversesqrt(squared);
    }
}

#include "batch.glsl"
