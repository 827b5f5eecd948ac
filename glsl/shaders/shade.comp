#version 460
#extension GL_GOOGLE_include_directive : require
// The images of the slab: a thread per pixel adds its shaded fragments by coverage. The other outputs come
// from the triangle that covers most samples, of equals the one that covers the first of them; they are
// empty where nothing covers more samples than any triangle.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;   // pixels
    uint outputs; // OUTPUT_*
    vec4 eye;        // w = 1: a place; w = 0: the direction towards an orthographic camera
    vec4 view_depth; // row that takes a world place to its distance along the viewing axis
    vec3 light_direction;
    vec3 light_color;
    vec3 background;
    float ambient;
} params;

PAGED(0, readonly, uint, pixels);
PAGED(1, readonly, SurfacePoint, points);
PAGED(2, readonly, vec4, point_colors);
PAGED(3, writeonly, vec4, color_out);
PAGED(4, writeonly, float, depth_out);
PAGED(5, writeonly, vec3, normal_out);
PAGED(6, writeonly, vec3, position_out);
PAGED(7, writeonly, vec2, uv_out);
PAGED(8, writeonly, uint, triangle_out);

const uint OUTPUT_DEPTH = 1u;
const uint OUTPUT_NORMAL = 2u;
const uint OUTPUT_POSITION = 4u;
const uint OUTPUT_UV = 8u;
const uint OUTPUT_TRIANGLE = 16u;

// Phong's highlight: share of the light, and exponent.
const float SPECULAR_STRENGTH = 0.2;
const float SPECULAR_EXPONENT = 32.0;
const uint NOTHING = 0xFFFFFFFFu;

vec3 phong(vec3 base, vec3 normal, vec3 position) {
    vec3 to_eye = normalize(params.eye.xyz - params.eye.w * position);
    float cosine = dot(normal, params.light_direction);
    float highlight = 0.0;
    if (cosine > 0.0) {
        vec3 mirrored = 2.0 * cosine * normal - params.light_direction;
        highlight = pow(max(dot(mirrored, to_eye), 0.0), SPECULAR_EXPONENT);
    }
    return base * params.ambient + params.light_color * (base * max(cosine, 0.0) + SPECULAR_STRENGTH * highlight);
}

void write_outputs(uint i, bool something, SurfacePoint point) {
    if ((params.outputs & OUTPUT_DEPTH) != 0u) {
        float depth = dot(params.view_depth, vec4(point.position, 1.0));
        STORE(depth_out, i, something ? depth : uintBitsToFloat(0x7F800000u));
    }
    if ((params.outputs & OUTPUT_NORMAL) != 0u) {
        STORE(normal_out, i, something ? point.normal : vec3(0.0));
    }
    if ((params.outputs & OUTPUT_POSITION) != 0u) {
        STORE(position_out, i, something ? point.position : vec3(0.0));
    }
    if ((params.outputs & OUTPUT_UV) != 0u) {
        STORE(uv_out, i, something ? point.uv : vec2(0.0));
    }
    if ((params.outputs & OUTPUT_TRIANGLE) != 0u) {
        STORE(triangle_out, i, something ? point.id : NOTHING);
    }
}

void element(uint i) {
    uint fragments = LOAD(pixels, i);
    uint first = fragments >> 3;
    uint number = min(fragments & 7u, 4u);
    vec3 color = vec3(0.0);
    uint empty = 4u;
    uint most = 0u;
    SurfacePoint main_point;
    for (uint k = 0u; k < number; ++k) {
        SurfacePoint point = LOAD(points, first + k);
        vec3 shaded = phong(LOAD(point_colors, first + k).rgb, point.normal, point.position);
        color += shaded * (0.25 * float(point.covered));
        empty -= point.covered;
        if (point.covered > most) {
            most = point.covered;
            main_point = point;
        }
    }
    color += params.background * (0.25 * float(empty));
    STORE(color_out, i, vec4(color, 1.0));
    write_outputs(i, most > 0u && most >= empty, main_point);
}

#include "batch.glsl"
