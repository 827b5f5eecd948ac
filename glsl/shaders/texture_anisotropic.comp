#version 460
#extension GL_GOOGLE_include_directive : require
// Maps by trilinear taps in a row along the longer axis of the footprint (after Schilling, Knittel and Strasser 1996, and
// McCormack et al. 1999). The row is a box, as the pixel is, so taps weigh alike; they are in pairs on either side of the
// middle, and the outermost pair weighs as much as the row reaches into its cells.
#include "common.glsl"
#include "texture_bindings.glsl"
#include "texture_footprint.glsl"
#include "texture_levels.glsl"

const uint MAX_PAIRS = uint(MAX_ANISOTROPY) / 2u;

// Taps have a width of their own: this brings them together until row and taps have the variance of a box of the width
// 2 halved. See the twin.
float narrowed(float halved, uint pairs) {
    float squared = 4.0 * halved * halved;
    float outermost = halved - float(pairs - 1u);
    return sqrt((squared - 1.0) / (squared - (float(pairs - 1u) + outermost * outermost * outermost) / halved));
}

vec4 filtered(TextureUse map, vec2 uv, vec2 uv_dx, vec2 uv_dy) {
    vec2 size = vec2(level_at(map, 0u).yz);
    Footprint footprint = footprint_of(size, uv_dx, uv_dy);
    bool known = finite(footprint.major);
    // There is nothing finer than the finest level: its texels are the narrowest taps.
    float width = known ? max(footprint.minor, 1.0) : 1.0;
    float level = known ? log2(width) : float(map.level_count);
    vec2 step_uv = known ? footprint.along * width / size : vec2(0.0);
    float halved = known ? clamp(0.5 * footprint.major / width, 0.5, float(MAX_PAIRS)) : 0.5;
    uint pairs = uint(ceil(halved));
    step_uv *= narrowed(halved, pairs);
    uvec2 wrap = wraps_of(map);
    vec4 sum = vec4(0.0);
    [[dont_unroll]] for (uint tap = 0u; tap < 2u * MAX_PAIRS && tap < 2u * pairs; ++tap) {
        float inner = float(tap >> 1u);
        float weight = min(halved - inner, 1.0);
        float place = (tap & 1u) == 0u ? inner + 0.5 * weight : -inner - 0.5 * weight;
        sum += weight * between_levels(map, uv + place * step_uv, level, wrap);
    }
    return sum / (2.0 * halved);
}

#include "texture_pass.glsl"
