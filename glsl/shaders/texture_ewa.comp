#version 460
#extension GL_GOOGLE_include_directive : require
// Maps by the elliptical weighted average (Greene and Heckbert 1986, Heckbert 1989): texels under the ellipse that the
// pixel covers, weighted by a Gaussian of the variance of the pixel's box. See the twin for where the numbers are from.
#include "common.glsl"
#include "texture_bindings.glsl"
#include "texture_footprint.glsl"
#include "texture_levels.glsl"

// Texels that the shorter half axis spans at least, wherever there are so many: the level is chosen by it.
const float FINEST_TEXELS = 2.0;
// Weights are exp(-r^2 / 2) - exp(-2) within r = 2: the Gaussian ends without a step.
const float REACH = 2.0;
const float EDGE = 0.1353352832366127;
// Variance of these weights along an axis.
const float KERNEL_VARIANCE = 0.5443211581443945;
// In texels: with less, the ellipse could slip between texels.
const float LEAST_VARIANCE = 0.15;
// Rows of texels under an ellipse, and texels of a row: its longer half axis is at most 16 * 4 texels, so REACH of its
// standard deviations are at most 2 * sqrt((64^2 + 16 + 3) / 12 / KERNEL_VARIANCE) = 50.3 texels.
const int MAX_SIDE = 102;

// No ellipse reaches the map from farther away: what is clamped need not be followed there.
const float FAR = 64.0;

// Place in texels, texel i at i.
float place_of(float u, int size, uint mode) {
    float clamped = clamp(u * float(size) - 0.5, -FAR, float(size) + FAR);
    return mode == WRAP_CLAMP ? clamped : periodic(u, mode) * float(size) - 0.5;
}

// xx, xy and yy in texels of a level; `scale` is its size by that of the finest.
vec3 variance(uvec4 level, vec2 scale, vec3 spread) {
    vec2 along = scale * scale * (spread.xz / 12.0 + 0.25) - 1.0 / 12.0;
    vec3 v = vec3(along.x, scale.x * scale.y * spread.y / 12.0, along.y);
    // Along a single texel nothing changes.
    v = level.y == 1u ? vec3(LEAST_VARIANCE, 0.0, v.z) : v;
    v = level.z == 1u ? vec3(v.x, 0.0, LEAST_VARIANCE) : v;
    float least = 0.5 * (v.x + v.z) - length(vec2(0.5 * (v.x - v.z), v.y));
    float missing = max(LEAST_VARIANCE - least, 0.0);
    return v + vec3(missing, 0.0, missing);
}

vec4 elliptical(uvec4 level, vec2 uv, vec3 v, uvec2 wrap) {
    ivec2 size = ivec2(level.yz);
    vec2 centre = vec2(place_of(uv.x, size.x, wrap.x), place_of(uv.y, size.y, wrap.y));
    ivec2 base = ivec2(integer(floor(centre.x)), integer(floor(centre.y)));
    centre -= floor(centre);
    float determinant = v.x * v.z - v.y * v.y;
    float reach = REACH * sqrt(v.z);
    vec4 sum = vec4(0.0);
    float total = 0.0;
    float y = ceil(centre.y - reach);
    [[dont_unroll]] for (int row = 0; row < MAX_SIDE && y <= centre.y + reach; ++row, y += 1.0) {
        float dy = y - centre.y;
        uint first = level.x + uint(repeated(base.y + integer(y), size.y, wrap.y) * size.x);
        // The row's part of the ellipse v.z dx^2 - 2 v.y dx dy + v.x dy^2 = REACH^2 determinant.
        float middle = centre.x + dy * v.y / v.z;
        float halved = sqrt(max(REACH * REACH - dy * dy / v.z, 0.0) * determinant / v.z);
        float x = ceil(middle - halved);
        [[dont_unroll]] for (int column = 0; column < MAX_SIDE && x <= middle + halved; ++column, x += 1.0) {
            float dx = x - centre.x;
            float squared = (v.z * dx * dx - 2.0 * v.y * dx * dy + v.x * dy * dy) / determinant;
            float weight = max(exp(-0.5 * squared) - EDGE, 0.0);
            sum += weight * TEXEL(first + uint(repeated(base.x + integer(x), size.x, wrap.x)));
            total += weight;
        }
    }
    sum /= total;
    return vec4(sum.rgb, min(sum.a * uintBitsToFloat(level.w), 1.0));
}

vec4 filtered(TextureUse map, vec2 uv, vec2 uv_dx, vec2 uv_dy) {
    uvec2 wrap = wraps_of(map);
    uint coarsest = map.level_count - 1u;
    vec2 size = vec2(level_at(map, 0u).yz);
    Footprint footprint = footprint_of(size, uv_dx, uv_dy);
    bool known = finite(footprint.major);
    float fade = known ? clamp(2.0 * footprint.major - 1.0, 0.0, 1.0) : 0.0;
    vec4 value = fade < 1.0 ? (1.0 - fade) * bilinear(level_at(map, known ? 0u : coarsest), uv, wrap) : vec4(0.0);
    if (fade == 0.0) {
        return value;
    }
    float level = min(log2(max(footprint.minor / FINEST_TEXELS, 1.0)), float(coarsest));
    float t = max(4.0 * fract(level) - 3.0, 0.0);
    float shrink = min(2.0 * FINEST_TEXELS * exp2(float(coarsest)) / footprint.minor, 1.0);
    vec3 spread = footprint.spread * shrink * shrink;
    [[dont_unroll]] for (uint k = 0u; k < 2u; ++k) {
        float weight = k == 0u ? 1.0 - t : t;
        if (weight > 0.0) {
            uvec4 at = level_at(map, uint(level) + k);
            value += fade * weight * elliptical(at, uv, variance(at, vec2(at.yz) / size, spread) / KERNEL_VARIANCE, wrap);
        }
    }
    return value;
}

#include "texture_pass.glsl"
