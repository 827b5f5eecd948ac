#version 460
#extension GL_GOOGLE_include_directive : require
// Fills a stream of 32-bit words with one value.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // words
    uint value;
} params;

PAGED(0, writeonly, uint, words);

void element(uint i) {
    STORE(words, i, params.value);
}

#include "batch.glsl"
