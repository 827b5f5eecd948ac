#version 460
#extension GL_GOOGLE_include_directive : require
// The images of the slab: a thread per pixel adds its shaded fragments by coverage, or takes what `composite` made of
// layers. The other outputs come
// from the triangle that covers most samples, of equals the one that covers the first of them; they are
// empty where nothing covers more samples than any triangle.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "appearance.glsl"
#include "texture_use.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;   // pixels
    uint outputs; // OUTPUT_*
    vec4 view_depth; // row that takes a world place to its distance along the viewing axis
    vec3 background;
    uint has_backdrop; // `backdrop` is shown instead
    uint uv_channels;
    uint has_layers; // colours are those of `layered`
} params;

PAGED(0, readonly, uint, pixels);
PAGED(1, readonly, SurfacePoint, points);
PAGED(2, readonly, Appearance, appearances);
PAGED(3, readonly, vec4, radiance);
PAGED(4, readonly, vec2, uvs);
PAGED(5, readonly, TextureUse, maps);
PAGED(6, writeonly, vec4, color_out);
PAGED(7, writeonly, float, depth_out);
PAGED(8, writeonly, vec3, normal_out);
PAGED(9, writeonly, vec3, position_out);
PAGED(10, writeonly, vec2, uv_out);
PAGED(11, writeonly, uint, triangle_out);
PAGED(12, readonly, vec3, backdrop);
PAGED(13, readonly, vec3, layered);
PAGED(14, readonly, float, transmittance); // of samples
PAGED(15, writeonly, uint, samples_out);

const uint OUTPUT_DEPTH = 1u;
const uint OUTPUT_NORMAL = 2u;
const uint OUTPUT_POSITION = 4u;
const uint OUTPUT_UV = 8u;
const uint OUTPUT_TRIANGLE = 16u;
const uint OUTPUT_SAMPLES = 32u;

const uint NOTHING = 0xFFFFFFFFu;

// In the set of the base colour map.
vec2 uv_of(SurfacePoint point) {
    uint channel = LOAD(maps, point.material * MAP_SLOTS + MAP_BASE_COLOR).uv_channel;
    mat3x2 corner;
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(uvs, point.vertices[k] * params.uv_channels + channel);
    }
    return corner * point.at;
}

void write_outputs(uint i, bool something, SurfacePoint point, vec3 normal) {
    if ((params.outputs & OUTPUT_DEPTH) != 0u) {
        float depth = dot(params.view_depth, vec4(point.position, 1.0));
        STORE(depth_out, i, something ? depth : uintBitsToFloat(0x7F800000u));
    }
    if ((params.outputs & OUTPUT_NORMAL) != 0u) {
        STORE(normal_out, i, something ? normal : vec3(0.0));
    }
    if ((params.outputs & OUTPUT_POSITION) != 0u) {
        STORE(position_out, i, something ? point.position : vec3(0.0));
    }
    if ((params.outputs & OUTPUT_UV) != 0u) {
        vec2 uv = vec2(0.0);
        if (something) {
            uv = uv_of(point);
        }
        STORE(uv_out, i, uv);
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
    uint shown = 0u;
    for (uint k = 0u; k < number; ++k) {
        uint covered = bitCount(LOAD(points, first + k).covered);
        color += LOAD(radiance, first + k).rgb * (0.25 * float(covered));
        empty -= covered;
        // Of relief each sample is a fragment.
        uint all = 0u;
        for (uint other = k; other < number; ++other) {
            bool same = LOAD(points, first + other).id == LOAD(points, first + k).id;
            all += same ? uint(bitCount(LOAD(points, first + other).covered)) : 0u;
        }
        if (all > most) {
            most = all;
            shown = first + k;
        }
    }
    float passes = float(empty);
    if (params.has_layers != 0u) {
        color = LOAD(layered, i);
        passes = 0.0;
        for (uint s = 0u; s < 4u; ++s) {
            passes += LOAD(transmittance, i * 4u + s);
        }
    }
    if (passes > 0.0) {
        color += (params.has_backdrop != 0u ? LOAD(backdrop, i) : params.background) * (0.25 * passes);
    }
    STORE(color_out, i, vec4(color, 1.0));
    bool something = most > 0u && most >= empty;
    if ((params.outputs & OUTPUT_SAMPLES) != 0u) {
        STORE(samples_out, i, number);
    }
    if (params.outputs != 0u) {
        SurfacePoint point;
        vec3 normal;
        if (something) {
            point = LOAD(points, shown);
            normal = LOAD(appearances, shown).normal;
        }
        write_outputs(i, something, point, normal);
    }
}

#include "batch.glsl"
