#version 460
#extension GL_GOOGLE_include_directive : require
// Known answer: f32 arithmetic is IEEE where Vulkan says so and close where it says so.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
} params;

struct Answer {
    float sum;
    float product;
    float chained; // a * b + c, rounded twice
    float quotient;
    float root;
    float floored;
    int truncated;
    float sine;
};

PAGED(0, readonly, vec3, operands);
PAGED(1, writeonly, Answer, answers);

void main() {
    uint i = thread_index();
    if (i >= params.count) {
        return;
    }
    vec3 abc = LOAD(operands, i);
    precise Answer answer;
    precise float product = abc.x * abc.y;
    answer.sum = abc.x + abc.y;
    answer.product = product;
    answer.chained = product + abc.z;
    answer.quotient = abc.x / abc.y;
    answer.root = sqrt(abs(abc.x));
    answer.floored = floor(abc.z);
    answer.truncated = int(abc.z);
    answer.sine = sin(abc.z);
    STORE(answers, i, answer);
}
