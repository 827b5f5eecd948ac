// Interprets the bytecode of `expression.rs`, whose `check` has proved every program within its limits.
// Include after pages.glsl, with INSTRUCTIONS_BINDING defined.
#include "functions.glsl"

struct Instruction {
    uint op;
    float value;
};

PAGED(INSTRUCTIONS_BINDING, readonly, Instruction, instructions);

const uint MAX_STACK = 16u;
const uint VARIABLE = 1u;

// Values an operation takes, two bits each: `Op::arity`.
uint arity(uint op) {
    return (op < 16u ? 0xa5565aa0u : 0x000e56f9u) >> (2u * (op & 15u)) & 3u;
}

float smooth_step(float e0, float e1, float x, out vec3 partial) {
    precise float t = clamp((x - e0) / (e1 - e0), 0.0, 1.0);
    float slope = t <= 0.0 || t >= 1.0 ? 0.0 : 6.0 * t * (1.0 - t) / (e1 - e0);
    partial = vec3(slope * (t - 1.0), -slope * t, slope);
    precise float value = t * t * (3.0 - 2.0 * t);
    return value;
}

float power_of(float x, float y) {
    return y == 0.0 ? 1.0 : exp2_of(y * log2_of(x));
}

// The value of one operation on a, b, c and its partial derivatives by them.
float operation(uint op, float immediate, float a, float b, float c, out vec3 partial) {
    partial = vec3(0.0);
    precise float value = immediate;
    switch (op) {
    case 2u:
        value = a + b;
        partial = vec3(1.0, 1.0, 0.0);
        break;
    case 3u:
        value = a - b;
        partial = vec3(1.0, -1.0, 0.0);
        break;
    case 4u:
        value = a * b;
        partial = vec3(b, a, 0.0);
        break;
    case 5u:
        value = a / b;
        partial = vec3(1.0 / b, -value / b, 0.0);
        break;
    case 6u:
        value = -a;
        partial.x = -1.0;
        break;
    case 7u:
        value = power_integer(a, int(immediate));
        partial.x = immediate == 0.0 ? 0.0 : immediate * (immediate == -31.0 ? value / a : power_integer(a, int(immediate) - 1));
        break;
    case 8u:
        value = power_of(a, b);
        partial = vec3(b * power_of(a, b - 1.0), value == 0.0 ? 0.0 : value * log2_of(a) * 0.69314718, 0.0);
        break;
    case 9u:
    case 10u:
    case 11u:
        vec2 sc = sine_cosine(a);
        value = op == 9u ? sc.x : (op == 10u ? sc.y : sc.x / sc.y);
        partial.x = op == 9u ? sc.y : (op == 10u ? -sc.x : 1.0 + value * value);
        break;
    case 12u:
        value = a < 0.0 ? NOT_A_NUMBER : sqrt(a);
        partial.x = 0.5 / value;
        break;
    case 13u:
        value = abs(a);
        partial.x = sign(a);
        break;
    case 14u:
        value = b < a ? b : a;
        partial = b < a ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
        break;
    case 15u:
        value = b > a ? b : a;
        partial = b > a ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
        break;
    case 16u:
        value = floor(a);
        break;
    case 17u:
        precise float periods = floor(a / b);
        value = a - b * periods;
        partial = vec3(1.0, -periods, 0.0);
        break;
    case 18u:
        value = a + (b - a) * c;
        partial = vec3(1.0 - c, c, b - a);
        break;
    case 19u:
        value = smooth_step(a, b, c, partial);
        break;
    case 20u:
        value = b < a ? 0.0 : 1.0;
        break;
    case 21u:
        value = sign(a);
        break;
    case 22u:
        value = exp2_of(a);
        partial.x = value * 0.69314718;
        break;
    case 23u:
        value = log2_of(a);
        partial.x = 1.44269504 / a;
        break;
    case 24u:
        value = arc_tangent2(a, b);
        partial = vec3(b, -a, 0.0) / (a * a + b * b);
        break;
    case 25u:
        vec4 noise = noise_of(vec3(a, b, c));
        value = noise.x;
        partial = noise.yzw;
        break;
    }
    return value;
}

float variable(float which, vec2 uv, vec3 position, vec3 normal) {
    uint k = uint(which);
    if (k < 2u) {
        return k == 0u ? uv.x : uv.y;
    }
    vec3 from = k < 5u ? position : normal;
    k = k < 5u ? k - 2u : k - 5u;
    return k == 0u ? from.x : (k == 1u ? from.y : from.z);
}

float evaluate(uint first, uint count, vec2 uv, vec3 position, vec3 normal) {
    float stack[MAX_STACK + 2u];
    uint top = 0u;
    for (uint k = 0u; k < count; ++k) {
        Instruction i = LOAD(instructions, first + k);
        uint at = top - arity(i.op);
        vec3 unused;
        float value = i.op == VARIABLE ? variable(i.value, uv, position, normal)
                                 : operation(i.op, i.value, stack[at], stack[at + 1u], stack[at + 2u], unused);
        stack[at] = value;
        top = at + 1u;
    }
    return stack[0];
}
