#version 460
// Moves what lies under each fragment to where its ray has landed: weights and their derivatives, place, normals, and how far
// away it is. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"
#include "relief.glsl"

#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "visibility_key.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform RelieveParams {
    uint count;
    uint uv_channels;
    uint finds_depth;  // else maps are shifted, and nothing else
    uint has_outlines; // of what has no course nothing is seen, and normals are those of the place that is struck
    uint tests;        // fragments are samples under test: what is missed becomes NOTHING, depths are told
    uint lifts;        // places are put on the heights above them, which a step may have gone below
} params;

PAGED(0, readonly, Fragment, fragments);
PAGED(1, , SurfacePoint, points);
PAGED(2, readonly, vec4, instance_rows);
PAGED(3, readonly, vec3, positions);
PAGED(4, readonly, vec3, normals);
PAGED(5, readonly, vec2, uvs);
PAGED(6, readonly, Relief, reliefs);
PAGED(7, readonly, ReliefLevel, relief_levels);
PAGED(8, readonly, float, texels);
PAGED(9, readonly, Course, courses);
PAGED(10, readonly, Landing, landings);

#include "course_texels.glsl"
#include "tiled.glsl"
#include "taps.glsl"
#include "relief_slope.glsl"
#include "bump.glsl"
#include "world.glsl"

// Weights of the corners at a place of the map; those it had where the corners have no area on the map.
vec3 weights_at(mat3x2 corners, vec2 place, vec3 known) {
    mat2 sides = mat2(corners[1] - corners[0], corners[2] - corners[0]);
    float area = sides[0].x * sides[1].y - sides[0].y * sides[1].x;
    if (area == 0.0) {
        return known;
    }
    vec2 way = place - corners[0];
    float b = (way.x * sides[1].y - way.y * sides[1].x) / area;
    float c = (sides[0].x * way.y - sides[0].y * way.x) / area;
    return vec3(1.0 - b - c, b, c);
}

vec3 clamped(vec3 weights) {
    vec3 at = max(weights, vec3(0.0));
    return at / (at.x + at.y + at.z);
}

// Of a pixel's side: each of its samples is shaded by itself, and the four are averaged.
const float SAMPLE_SIDE = 0.5;

// How the weights change from sample to sample: the facet that is struck moves with them by `along`, and stays under the pixel.
void derive(inout SurfacePoint point, uint row, vec2 at_px, vec3 x, mat2x3 along) {
    vec4 w = LOAD(instance_rows, row + 3u);
    vec3 across = LOAD(instance_rows, row).xyz - at_px.x * w.xyz;
    vec3 down = LOAD(instance_rows, row + 1u).xyz - at_px.y * w.xyz;
    float far = dot(w, vec4(x, 1.0));
    vec2 a = across * along;
    vec2 b = down * along;
    float determinant = a.x * b.y - a.y * b.x;
    if (determinant == 0.0) {
        return;
    }
    vec2 dx = vec2(b.y, -b.x) * (SAMPLE_SIDE * far / determinant);
    vec2 dy = vec2(-a.y, a.x) * (SAMPLE_SIDE * far / determinant);
    point.at_dx = vec3(-dx.x - dx.y, dx);
    point.at_dy = vec3(-dy.x - dy.y, dy);
}

// Puts the point where the ray has landed.
void strike(inout SurfacePoint point, Relief relief, uint level, vec2 at_px, Landing landing, mat3x2 texel_corners) {
    mat3 corner;
    mat3 normal;
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(positions, point.vertices[k]);
        normal[k] = LOAD(normals, point.vertices[k]);
    }
    uint row = point.instance * INSTANCE_ROWS;
    vec3 x = landing.x;
    vec3 n = unit_or_zero(normal * clamped(point.at));
    vec2 slope = slope_at(relief, level, landing.place);
    vec2 rises = slope * mat2(texel_corners[1] - texel_corners[0], texel_corners[2] - texel_corners[0]);
    vec2 seen = landing.kind == LANDED_LEVEL ? vec2(0.0) : rises;
    mat2x3 along = mat2x3(corner[1] - corner[0] + n * seen.x, corner[2] - corner[0] + n * seen.y);
    derive(point, row, at_px, x, along);
    vec3 facet = n - surface_gradient(corner[1] - corner[0], corner[2] - corner[0], n, rises);
    point.facing = unit_or_zero(mapped(row + NORMAL_ROW, vec4(facet, 0.0)));
    point.normal = unit_or_zero(mapped(row + NORMAL_ROW, vec4(n, 0.0)));
    float lift = params.lifts != 0u ? landing.lift : 0.0;
    point.position = mapped(row + WORLD_ROW, vec4(x + lift * n, 1.0));
    point.flip = 1.0;
    float depth = dot(LOAD(instance_rows, row + 2u), vec4(x, 1.0)) / dot(LOAD(instance_rows, row + 3u), vec4(x, 1.0));
    if (params.tests != 0u) {
        point.covered = floatBitsToUint(clamp(depth, 0.0, 1.0));
    }
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    if (relief.level_count == 0u) {
        return;
    }
    Landing landing = LOAD(landings, i);
    Course course = LOAD(courses, i);
    if (landing.kind == LANDED_NOWHERE) {
        if (params.tests != 0u && (params.has_outlines != 0u || course.nodes > 0u)) {
            point.id = NOTHING;
            STORE(points, i, point);
        }
        return;
    }
    mat3x2 texel_corners = texels_of(relief, point.vertices, course.level);
    vec2 turns = landing.turns;
    texel_corners = mat3x2(texel_corners[0] + turns, texel_corners[1] + turns, texel_corners[2] + turns);
    point.at = weights_at(texel_corners, landing.place, point.at);
    if (params.finds_depth != 0u) {
        strike(point, relief, course.level, LOAD(fragments, i).at_px, landing, texel_corners);
    }
    STORE(points, i, point);
}

#include "batch.glsl"
