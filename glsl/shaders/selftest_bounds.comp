#version 460
#extension GL_GOOGLE_include_directive : require
// Known answer: reads past the end of a stream give 0, writes past it are dropped.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
} params;

PAGED(0, readonly, uint, values);
PAGED(1, readonly, uint, indices);
PAGED(2, writeonly, uint, results);

void main() {
    uint i = thread_index();
    if (i >= params.count) {
        return;
    }
    STORE(results, i, LOAD(values, LOAD(indices, i)));
    STORE(results, params.count + i * 977u, 0xBADu);
}
