#version 460
#extension GL_GOOGLE_include_directive : require
// Maps by two levels of their pyramid, chosen by the longer side of the pixel's footprint (Williams 1983).
#include "common.glsl"
#include "texture_bindings.glsl"

// Level of detail: log2 of the pixel's longer side in texels of the finest level.
float level_of(vec2 size, vec2 dx, vec2 dy, uint level_count) {
    float footprint = max(dot(dx * size, dx * size), dot(dy * size, dy * size));
    return clamp(0.5 * log2(max(footprint, 1.0)), 0.0, float(level_count - 1u));
}

vec4 filtered(TextureUse map, vec2 uv, vec2 uv_dx, vec2 uv_dy) {
    uvec2 wrap = wraps_of(map);
    float level = level_of(vec2(LOAD(levels, map.level_first).yz), uv_dx, uv_dy, map.level_count);
    uint finer = min(uint(level), map.level_count - 1u);
    uint coarser = min(finer + 1u, map.level_count - 1u);
    vec4 value = vec4(0.0);
    for (uint k = 0u; k < 2u; ++k) {
        float t = level - float(finer);
        float weight = k == 0u ? 1.0 - t : t;
        if (weight > 0.0) {
            value += weight * bilinear(LOAD(levels, map.level_first + (k == 0u ? finer : coarser)), uv, wrap);
        }
    }
    return value;
}

#include "texture_pass.glsl"
