#version 460
// Fills a stream of 32-bit words with one value.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // words
    uint value;
} params;

PAGED(0, writeonly, uint, words);

void main() {
    uint i = thread_index();
    if (i < params.count) {
        STORE(words, i, params.value);
    }
}
