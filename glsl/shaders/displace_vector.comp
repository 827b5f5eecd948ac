#version 460
// Adds one vector layer: x along the tangent, y along the bitangent, z along the displacement direction;
// or mesh-local axes. A surface can fold over itself, which heights cannot do.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first;
    uint accumulate;
    Layer layer;
} params;

PAGED(0, readonly, vec4, base_position_u);
PAGED(1, readonly, vec4, base_direction_v);
PAGED(2, readonly, vec3, base_normals);
PAGED(3, readonly, vec4, base_tangents);
PAGED(4, readonly, float, texels);
PAGED(5, , vec3, positions);

vec3 texel(const uint at) {
    uint i = params.layer.first + 3u * at;
    return vec3(LOAD_TEXEL(i), LOAD_TEXEL(i + 1u), LOAD_TEXEL(i + 2u));
}

vec3 bilinear(const vec2 p) {
    vec2 corner = floor(p);
    precise vec2 f = p - corner;
    uvec3 x = wrapped(params.layer.across, integer(corner.x));
    uvec3 y = wrapped(params.layer.down, integer(corner.y)) * params.layer.row;
    precise vec3 above = texel(y.x + x.x) * (1.0 - f.x) + texel(y.x + x.y) * f.x;
    precise vec3 below = texel(y.y + x.x) * (1.0 - f.x) + texel(y.y + x.y) * f.x;
    precise vec3 value = above * (1.0 - f.y) + below * f.y;
    return value;
}

void element(uint i) {
    i += params.first;
    vec4 position_u = LOAD(base_position_u, i);
    vec4 direction_v = LOAD(base_direction_v, i);
    vec2 p = texel_space(params.layer, vec2(position_u.w, direction_v.w));
    precise vec3 vector = (bilinear(p) - params.layer.midlevel) * params.layer.scale;
    if (params.layer.kind == VECTOR_TANGENT) {
        vec3 normal = LOAD(base_normals, i);
        vec4 tangent = LOAD(base_tangents, i);
        vec3 bitangent = cross(normal, tangent.xyz) * tangent.w;
        vector = tangent.xyz * vector.x + bitangent * vector.y + direction_v.xyz * vector.z;
    }
    vec3 from = params.accumulate == 0u ? position_u.xyz : LOAD(positions, i);
    precise vec3 position = from + vector;
    STORE(positions, i, position);
}

#include "batch.glsl"
