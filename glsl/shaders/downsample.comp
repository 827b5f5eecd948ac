#version 460
#extension GL_GOOGLE_include_directive : require
// Pixels of an image as means over squares of a finer one. A thread per pixel.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // pixels
    uint width; // of the image
    uint side;  // finer pixels along a side of a square, up to 16
} params;

PAGED(0, readonly, vec4, fine);
PAGED(1, writeonly, vec4, color_out);

void element(uint i) {
    uvec2 at = uvec2(i % params.width, i / params.width) * params.side;
    vec4 sum = vec4(0.0);
    [[dont_unroll]] for (uint k = 0u; k < 256u && k < params.side * params.side; ++k) {
        uvec2 place = at + uvec2(k % params.side, k / params.side);
        sum += LOAD(fine, place.y * params.width * params.side + place.x);
    }
    STORE(color_out, i, sum / float(params.side * params.side));
}

#include "batch.glsl"
