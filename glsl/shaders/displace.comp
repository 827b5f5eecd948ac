#version 460
// Adds one height layer: position = base + scale (h − midlevel) D. The hot loop of every job.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first;      // fine vertex of the first thread
    uint accumulate; // 0: from the base; 1: on top of the layers before
    Layer layer;
} params;

PAGED(0, readonly, vec4, base_position_u);
PAGED(1, readonly, vec4, base_direction_v);
PAGED(2, readonly, float, texels);
PAGED(3, , vec3, positions);

Layer layer;
#define PREPARE layer = params.layer;

void element(uint i) {
    i += params.first;
    vec4 position_u = LOAD(base_position_u, i);
    vec4 direction_v = LOAD(base_direction_v, i);
    vec2 p = texel_space(layer, vec2(position_u.w, direction_v.w));
    vec2 corner = floor(p);
    precise vec2 f = p - corner;
    uvec3 x = wrapped(layer.across, integer(corner.x)) + layer.first;
    uvec3 y = wrapped(layer.down, integer(corner.y)) * layer.row;
    float t00 = LOAD_TEXEL(y.x + x.x);
    float t10 = LOAD_TEXEL(y.x + x.y);
    float t01 = LOAD_TEXEL(y.y + x.x);
    float t11 = LOAD_TEXEL(y.y + x.y);
    precise float above = t00 * (1.0 - f.x) + t10 * f.x;
    precise float below = t01 * (1.0 - f.x) + t11 * f.x;
    precise float value = above * (1.0 - f.y) + below * f.y;
    precise float height = (value - layer.midlevel) * layer.scale;
    vec3 from = params.accumulate == 0u ? position_u.xyz : LOAD(positions, i);
    precise vec3 position = from + direction_v.xyz * height;
    STORE(positions, i, position);
}

#include "batch.glsl"
