#version 460
// Adds one expression layer: position = base + scale (value − midlevel) D.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"
#define INSTRUCTIONS_BINDING 3
#include "expression.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first;
    uint accumulate;
    uint with_normals; // whether the expression reads the normal
    Layer layer;
} params;

PAGED(0, readonly, vec4, base_position_u);
PAGED(1, readonly, vec4, base_direction_v);
PAGED(2, readonly, vec3, base_normals);
PAGED(4, , vec3, positions);

void element(uint i) {
    i += params.first;
    vec4 position_u = LOAD(base_position_u, i);
    vec4 direction_v = LOAD(base_direction_v, i);
    vec3 normal = vec3(0.0);
    if (params.with_normals != 0u) {
        normal = LOAD(base_normals, i);
    }
    vec2 uv = texel_space(params.layer, vec2(position_u.w, direction_v.w));
    float variables[8] =
        float[8](uv.x, uv.y, position_u.x, position_u.y, position_u.z, normal.x, normal.y, normal.z);
    float value = evaluate(params.layer.first, params.layer.row, variables);
    precise float height = (value - params.layer.midlevel) * params.layer.scale;
    vec3 from = params.accumulate == 0u ? position_u.xyz : LOAD(positions, i);
    precise vec3 position = from + direction_v.xyz * height;
    STORE(positions, i, position);
}

#include "batch.glsl"
