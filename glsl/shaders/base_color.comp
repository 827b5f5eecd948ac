#version 460
#extension GL_GOOGLE_include_directive : require
// Linear base colour of each fragment: factor, vertex colour, and the map by our own trilinear filter. A
// thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "material.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Material, materials);
// Per mip level: first texel, width, height.
PAGED(2, readonly, uvec3, levels);
// Two texels each, linear RGBA in half floats.
PAGED(3, readonly, uvec4, texels);
// In: vertex colour. Out: base colour.
PAGED(4, , vec4, point_colors);

// Into one period of a repeating map, two of a mirrored one, so that texel numbers stay small.
float periodic(float u, uint mode) {
    float period = mode == WRAP_MIRROR ? 2.0 : 1.0;
    return mode == WRAP_CLAMP ? clamp(u, -1.0, 2.0) : u - floor(u / period) * period;
}

// Texel number for the number of a place in the period; one texel may stick out on either side.
int wrapped(int i, int size, uint mode) {
    if (mode == WRAP_REPEAT) {
        i = i < 0 ? i + size : (i >= size ? i - size : i);
    } else if (mode == WRAP_MIRROR) {
        i = i < 0 ? -1 - i : i;
        i = i >= 2 * size ? i - 2 * size : i;
        i = i >= size ? 2 * size - 1 - i : i;
    }
    return clamp(i, 0, size - 1);
}

vec4 texel(uint i) {
    uvec4 pair = LOAD(texels, i >> 1);
    uvec2 bits = (i & 1u) == 0u ? pair.xy : pair.zw;
    return vec4(unpackHalf2x16(bits.x), unpackHalf2x16(bits.y));
}

vec4 bilinear(uvec3 level, vec2 uv, uvec2 wrap) {
    ivec2 size = ivec2(level.yz);
    vec2 p = vec2(periodic(uv.x, wrap.x), periodic(uv.y, wrap.y)) * vec2(size) - 0.5;
    vec2 f = p - floor(p);
    ivec2 i = ivec2(integer(floor(p.x)), integer(floor(p.y)));
    ivec2 x = ivec2(wrapped(i.x, size.x, wrap.x), wrapped(i.x + 1, size.x, wrap.x));
    ivec2 y = ivec2(wrapped(i.y, size.y, wrap.y), wrapped(i.y + 1, size.y, wrap.y)) * size.x;
    vec4 top = mix(texel(level.x + uint(y.x + x.x)), texel(level.x + uint(y.x + x.y)), f.x);
    vec4 bottom = mix(texel(level.x + uint(y.y + x.x)), texel(level.x + uint(y.y + x.y)), f.x);
    return mix(top, bottom, f.y);
}

// Level of detail: log2 of the pixel's longer side in texels of the finest level.
float level_of(vec2 size, vec2 dx, vec2 dy, uint level_count) {
    float footprint = max(dot(dx * size, dx * size), dot(dy * size, dy * size));
    return clamp(0.5 * log2(max(footprint, 1.0)), 0.0, float(level_count - 1u));
}

vec4 trilinear(Material m, vec2 uv, vec2 dx, vec2 dy) {
    uvec2 wrap = uvec2(m.wrap & 3u, m.wrap >> 2);
    float level = level_of(vec2(LOAD(levels, m.level_first).yz), dx, dy, m.level_count);
    uint finer = min(uint(level), m.level_count - 1u);
    uint coarser = min(finer + 1u, m.level_count - 1u);
    vec4 color = vec4(0.0);
    for (uint k = 0u; k < 2u; ++k) {
        float t = level - float(finer);
        float weight = k == 0u ? 1.0 - t : t;
        if (weight > 0.0) {
            color += weight * bilinear(LOAD(levels, m.level_first + (k == 0u ? finer : coarser)), uv, wrap);
        }
    }
    return color;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Material m = LOAD(materials, point.material);
    vec4 color = LOAD(point_colors, i) * m.base_color;
    if (m.level_count > 0u) {
        mat2x3 map = mat2x3(m.map_u, m.map_v);
        color *= trilinear(m, vec3(point.uv, 1.0) * map, vec3(point.uv_dx, 0.0) * map, vec3(point.uv_dy, 0.0) * map);
    }
    STORE(point_colors, i, color);
}

#include "batch.glsl"
