#version 460
// Normals of what relief has struck, where it is seen larger than it is on the map: those of the bilinear heights themselves,
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
PAGED(5, readonly, March, marches);
PAGED(6, readonly, Bump, bumps);
PAGED(7, , Appearance, appearances);

#include "course_texels.glsl"

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    if (relief.level_count == 0u || LOAD(courses, i).nodes < 2u || LOAD(marches, i).s < 0.0) {
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
    vec3 normal = mix(LOAD(appearances, i).normal, point.facing, share);
    float squared = dot(normal, normal);
    if (squared > 1e-12) {
        LOAD(appearances, i).normal = normal * inversesqrt(squared);
    }
}

#include "batch.glsl"
