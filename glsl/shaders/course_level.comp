#version 460
// Which level of its material's height map is marched under each fragment, before its course is made. A thread per fragment.
//
// It is the coarsest whose texels are no wider than a sample, half a pixel of the image that is rendered, along the shorter
// axis of its footprint on the base: each of a pixel's four samples is marched and shaded by itself. So a texel is at least
// half a sample wide, and what samples can resolve is kept. The more of them a pixel is made of, the nearer the picture
// comes to that of the finest heights. The footprint is that of the base where it is seen, or of its nearest rim where
// only what stands on it is.
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
PAGED(4, readonly, vec2, uvs);
PAGED(5, readonly, Relief, reliefs);
PAGED(6, readonly, ReliefLevel, relief_levels);
PAGED(7, writeonly, Course, courses);

#include "course_texels.glsl"

// Texels of the finest level for each sample, along the shorter axis of its footprint; 0 where the map has no area.
float texels_per_sample(Relief relief, SurfacePoint point, vec2 at_px) {
    uint row = point.instance * INSTANCE_ROWS;
    vec4 w = LOAD(instance_rows, row + 3u);
    mat3 corner;
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(positions, point.vertices[k]);
    }
    mat2x3 sides = mat2x3(corner[1] - corner[0], corner[2] - corner[0]);
    // Pixels of each side, times how far away it is.
    vec2 across = (LOAD(instance_rows, row).xyz - at_px.x * w.xyz) * sides;
    vec2 down = (LOAD(instance_rows, row + 1u).xyz - at_px.y * w.xyz) * sides;
    mat3x2 texels = texels_of(relief, point.vertices, 0u);
    vec2 a = texels[1] - texels[0];
    vec2 b = texels[2] - texels[0];
    float area = a.x * b.y - a.y * b.x;
    // And of each texel, times the area.
    vec2 x = vec2(across.x * b.y - across.y * a.y, across.y * a.x - across.x * b.x);
    vec2 y = vec2(down.x * b.y - down.y * a.y, down.y * a.x - down.x * b.x);
    // Twice the greater singular value, as there are two samples across: unlike the less, it stands wherever the base is seen from the side.
    float most = length(vec2(x.x + y.y, x.y - y.x)) + length(vec2(x.x - y.y, x.y + y.x));
    float far = dot(w, vec4(corner * point.at, 1.0));
    return most > 0.0 ? abs(far * area / most) : 0.0;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    int level = 0;
    if (relief.level_count > 1u) {
        float texels = texels_per_sample(relief, point, LOAD(fragments, i).at_px);
        // The exponent: no rounding of logarithms.
        level = clamp((floatBitsToInt(texels) >> 23) - 127, 0, int(relief.level_count) - 1);
    }
    STORE(courses, i, Course(0u, point.material, uint(level), 0.0, 0u));
}

#include "batch.glsl"
