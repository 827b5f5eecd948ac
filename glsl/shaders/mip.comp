#version 460
#extension GL_GOOGLE_include_directive : require
// One mip level from the one above it: box filter in linear light, 2 texels wide where the size is even
// and 3 (polyphase) where it is odd. A thread writes two texels, one element of the stream.
#include "common.glsl"
#include "pages.glsl"
#include "texel_pair.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;        // pairs of target texels
    uint source_first; // texels
    uint target_first;
    uvec2 source_size;
    uvec2 target_size;
} params;

PAGED(0, , TexelPair, texels);

// Weights of source texels 2i, 2i + 1, 2i + 2 in target texel i.
vec3 weights(uint i, uint source_size, uint target_size) {
    if (source_size == 1u) {
        return vec3(1.0, 0.0, 0.0);
    }
    if ((source_size & 1u) == 0u) {
        return vec3(0.5, 0.5, 0.0);
    }
    return vec3(float(target_size - i), float(target_size), float(i + 1u)) / float(source_size);
}

vec4 filtered(uint texel) {
    uvec2 at = uvec2(texel % params.target_size.x, texel / params.target_size.x);
    vec3 wx = weights(at.x, params.source_size.x, params.target_size.x);
    vec3 wy = weights(at.y, params.source_size.y, params.target_size.y);
    vec4 sum = vec4(0.0);
    [[dont_unroll]] for (uint y = 0u; y < 3u; ++y) {
        [[dont_unroll]] for (uint x = 0u; x < 3u; ++x) {
            float weight = wx[x] * wy[y];
            if (weight > 0.0) {
                uint source = params.source_first + (at.y * 2u + y) * params.source_size.x + at.x * 2u + x;
                sum += weight * TEXEL(source);
            }
        }
    }
    return sum;
}

void element(uint i) {
    uint texels_in_level = params.target_size.x * params.target_size.y;
    uint first = i * 2u;
    vec4 second = first + 1u < texels_in_level ? filtered(first + 1u) : vec4(0.0);
    STORE(texels, params.target_first / 2u + i, TexelPair(vec4[2](filtered(first), second)));
}

#include "batch.glsl"
