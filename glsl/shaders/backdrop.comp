#version 460
#extension GL_GOOGLE_include_directive : require
// What is seen of an environment behind everything: a thread per pixel.
#include "common.glsl"
#include "pages.glsl"
#include "texel_pair.glsl"
#include "trigonometry.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // pixels
    ivec2 slab_px;
    ivec2 slab_size_px;
    uint mips; // levels of the environment's map
    // World direction at the image's top left corner, and its change by pixels; of any length.
    vec3 direction;
    vec3 direction_dx;
    vec3 direction_dy;
} params;

PAGED(0, readonly, uvec4, environment_levels);
PAGED(1, readonly, TexelPair, environment_texels);
PAGED(2, writeonly, vec3, backdrop);
#include "environment.glsl"

void element(uint i) {
    uint width = uint(params.slab_size_px.x);
    vec2 at = vec2(params.slab_px + ivec2(i % width, i / width)) + 0.5;
    vec3 d = params.direction + at.x * params.direction_dx + at.y * params.direction_dy;
    float inverse = inversesqrt(dot(d, d));
    d *= inverse;
    vec3 dx = params.direction_dx * inverse;
    vec3 dy = params.direction_dy * inverse;
    dx -= dot(dx, d) * d;
    dy -= dot(dy, d) * d;
    float footprint = sqrt(max(dot(dx, dx), dot(dy, dy)));
    STORE(backdrop, i, environment_mirror(d, footprint, params.mips));
}

#include "batch.glsl"
