#version 460
#extension GL_GOOGLE_include_directive : require
// Maps by two levels of their pyramid, chosen by the longer side of the pixel's footprint (Williams 1983).
#include "common.glsl"
#include "texture_bindings.glsl"
#include "texture_footprint.glsl"
#include "texture_levels.glsl"

// Level of detail: log2 of the pixel's longer side in texels of the finest level; the coarsest where the sides are not
// numbers.
float level_of(vec2 size, vec2 dx, vec2 dy, uint level_count) {
    vec2 squared = vec2(dot(dx * size, dx * size), dot(dy * size, dy * size));
    float coarsest = float(level_count - 1u);
    return finite(squared.x + squared.y) ? min(0.5 * log2(max(max(squared.x, squared.y), 1.0)), coarsest) : coarsest;
}

vec4 filtered(TextureUse map, vec2 uv, vec2 uv_dx, vec2 uv_dy) {
    float level = level_of(vec2(level_at(map, 0u).yz), uv_dx, uv_dy, map.level_count);
    return between_levels(map, uv, level, wraps_of(map));
}

#include "texture_pass.glsl"
