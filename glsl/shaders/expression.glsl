// Interprets the bytecode of `expression.rs`, whose `check` has proved every program within its limits.
// Include after pages.glsl, with INSTRUCTIONS_BINDING defined; with JETS defined it computes derivatives
// along two directions as well.
#include "functions.glsl"

struct Instruction {
    uint op;
    float value;
};

PAGED(INSTRUCTIONS_BINDING, readonly, Instruction, instructions);

const uint MAX_STACK = 16u;
const uint VARIABLE = 1u;
const float LN2 = 0.69314718;

#ifdef JETS
// A value and its derivatives.
#define NUMBER vec3
#define VALUE(number) (number).x
// The partial derivatives of an operation by its operands.
#define BY1(x) da = x
#define BY2(x, y) da = x; db = y
#define BY3(x, y, z) da = x; db = y; dc = z
#else
#define NUMBER float
#define VALUE(number) (number)
#define BY1(x)
#define BY2(x, y)
#define BY3(x, y, z)
#endif

// Values an operation takes, two bits each: `Op::arity`.
uint arity(const uint op) {
    return (op < 16u ? 0xa5555aa0u : 0x000395b9u) >> (2u * (op & 15u)) & 3u;
}

#ifdef JETS
// What is flat stays flat, even beside an infinite slope.
vec2 chained(const float partial, const vec2 derivative) {
    return mix(partial * derivative, vec2(0.0), equal(partial * sign(derivative), vec2(0.0)));
}
#endif

// `variables` in the order of `Variable`.
NUMBER evaluate(const uint first, const uint count, const NUMBER variables[8]) {
    NUMBER known[8] = variables;
    NUMBER stack[MAX_STACK + 2u];
    uint top = 0u;
    for (uint k = 0u; k < count; ++k) {
        Instruction i = LOAD(instructions, first + k);
        uint at = top - arity(i.op);
        top = at + 1u;
        if (i.op == VARIABLE) {
            stack[at] = known[uint(i.value) & 7u];
            continue;
        }
        float a = VALUE(stack[at]);
        float b = VALUE(stack[at + 1u]);
        float c = VALUE(stack[at + 2u]);
        float da = 0.0, db = 0.0, dc = 0.0;
        precise float value = i.value;
        switch (i.op) {
        case 2u:
            value = a + b;
            BY2(1.0, 1.0);
            break;
        case 3u:
            value = a - b;
            BY2(1.0, -1.0);
            break;
        case 4u:
            value = a * b;
            BY2(b, a);
            break;
        case 5u:
            value = a / b;
            BY2(1.0 / b, -value / b);
            break;
        case 6u:
            value = -a;
            BY1(-1.0);
            break;
        case 7u:
            value = power_integer(a, int(i.value));
            BY1(i.value * (i.value > 0.0 ? power_integer(a, int(i.value) - 1) : value / a));
            break;
        case 8u:
            value = a * a * (3.0 - 2.0 * a);
            BY1(6.0 * a * (1.0 - a));
            break;
        case 9u:
        case 10u:
        case 11u:
            vec2 sc = sine_cosine(a);
            value = i.op == 9u ? sc.x : (i.op == 10u ? sc.y : sc.x / sc.y);
            BY1(i.op == 9u ? sc.y : (i.op == 10u ? -sc.x : 1.0 + value * value));
            break;
        case 12u:
            value = a < 0.0 ? NOT_A_NUMBER : sqrt(a);
            BY1(0.5 / value);
            break;
        case 13u:
            value = abs(a);
            BY1(sign(a));
            break;
        case 14u:
        case 15u:
            bool second = i.op == 14u ? b < a : b > a;
            value = second ? b : a;
            BY2(float(!second), float(second));
            break;
        case 16u:
            value = floor(a);
            break;
        case 17u:
            precise float periods = floor(a / b);
            value = a - b * periods;
            BY2(1.0, -periods);
            break;
        case 18u:
            value = a + (b - a) * c;
            BY3(1.0 - c, c, b - a);
            break;
        case 19u:
            value = b < a ? 0.0 : 1.0;
            break;
        case 20u:
            value = sign(a);
            break;
        case 21u:
            value = exp2_of(a);
            BY1(value * LN2);
            break;
        case 22u:
            value = log2_of(a);
            BY1(1.0 / (LN2 * a));
            break;
        case 23u:
            value = arc_tangent2(a, b);
            BY2(b / (a * a + b * b), -a / (a * a + b * b));
            break;
        case 24u:
            vec4 noise = noise_of(vec3(a, b, c));
            value = noise.x;
            BY3(noise.y, noise.z, noise.w);
            break;
        }
#ifdef JETS
        stack[at] = vec3(value, chained(da, stack[at].yz) + chained(db, stack[at + 1u].yz) + chained(dc, stack[at + 2u].yz));
#else
        stack[at] = value;
#endif
    }
    return stack[0];
}
