#version 460
#extension GL_GOOGLE_include_directive : require
// The map as a lobe of one roughness sees it, the viewer in the lobe's middle (the split sum's first factor, Karis 2013), by
// filtered importance sampling (Krivanek and Colbert 2008). A thread writes two texels, one element of the stream.
#include "common.glsl"
#include "pages.glsl"
#include "texel_pair.glsl"
#include "trigonometry.glsl"
#include "hammersley.glsl"
#include "brdf.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;        // pairs of target texels
    uint target_first; // texel, even
    uvec2 target_size;
    uint mips;         // levels of the map
    uint samples;      // a power of two
    float roughness;   // perceptual
} params;

PAGED(0, readonly, uvec4, environment_levels);
PAGED(1, , TexelPair, environment_texels);
#include "environment.glsl"

// Levels up: samples overlap a little, so that none shows by itself.
const float BIAS = 0.5;

// East, south and outwards at a texel's centre.
mat3 frame_at(uint texel) {
    vec2 at = (vec2(texel % params.target_size.x, texel / params.target_size.x) + 0.5) / vec2(params.target_size);
    vec2 turn = sine_cosine(2.0 * HALF_TURN * (at.x - 0.5));
    vec2 down = sine_cosine(HALF_TURN * at.y);
    return mat3(
        vec3(-turn.x, 0.0, turn.y), vec3(down.y * turn.y, -down.x, down.y * turn.x),
        vec3(down.x * turn.y, down.y, down.x * turn.x));
}

vec4 seen(uint texel) {
    mat3 frame = frame_at(texel);
    float alpha = max(params.roughness * params.roughness, MIN_ALPHA);
    float squared = alpha * alpha;
    vec2 size = vec2(LOAD(environment_levels, 0u).yz);
    float texel_angle = 2.0 * HALF_TURN / size.x * (HALF_TURN / size.y);
    vec4 sum = vec4(0.0);
    uint samples = min(params.samples, 65536u);
    [[dont_unroll]] for (uint k = 0u; k < samples; ++k) {
        vec2 point = hammersley(k, samples);
        float spread = 1.0 + (squared - 1.0) * point.y;
        float z = sqrt((1.0 - point.y) / spread);
        float radius = sqrt(squared * point.y / spread);
        vec2 turn = sine_cosine(2.0 * HALF_TURN * point.x);
        vec3 light = vec3(2.0 * z * radius * turn.y, 2.0 * z * radius * turn.x, 2.0 * z * z - 1.0);
        if (light.z > 0.0) {
            // Density over light is D / 4, since the half vector's cosines with normal and view are one.
            float density = spread * spread / (4.0 * HALF_TURN * squared);
            float level = 0.5 * log2(1.0 / (float(samples) * density * texel_angle)) + BIAS;
            // As a viewer in the lobe's middle sees it, masking and all.
            float weight = light.z * visibility(alpha, 1.0, light.z);
            sum += weight * vec4(environment_trilinear(place_of(frame * light), level, params.mips), 1.0);
        }
    }
    return vec4(sum.rgb / sum.a, 1.0);
}

void element(uint i) {
    uint texels = params.target_size.x * params.target_size.y;
    vec4 second = i * 2u + 1u < texels ? seen(i * 2u + 1u) : vec4(0.0);
    STORE(environment_texels, params.target_first / 2u + i, TexelPair(vec4[2](seen(i * 2u), second)));
}

#include "batch.glsl"
