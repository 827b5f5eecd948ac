#version 460
// Adds one expression layer to the jets of its detail's samples.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#include "frame.glsl"
#include "sample.glsl"
#include "jets.glsl"
#include "map.glsl"
#define INSTRUCTIONS_BINDING 9
#include "expression.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint detail;
    uint layer;
    uint accumulate;
} params;

PAGED(8, readonly, Layer, layers);

// A flat operand stays flat even where the slope is infinite.
vec2 chained(float partial, vec2 derivative) {
    return mix(partial * derivative, vec2(0.0), equal(derivative, vec2(0.0)));
}

// Like `evaluate`, over jets. The columns of `position` and `normal` are value and derivatives.
vec3 evaluate_jet(Layer layer, vec3 u, vec3 v, mat3 position, mat3 normal) {
    vec3 stack[MAX_STACK + 2u];
    uint top = 0u;
    for (uint k = 0u; k < layer.row; ++k) {
        Instruction i = LOAD(instructions, layer.first + k);
        uint operands = arity(i.op);
        uint at = top - operands;
        vec3 result;
        if (i.op == VARIABLE) {
            for (int part = 0; part < 3; ++part) {
                result[part] = variable(i.value, vec2(u[part], v[part]), position[part], normal[part]);
            }
        } else {
            vec3 a = operands > 0u ? stack[at] : vec3(0.0);
            vec3 b = operands > 1u ? stack[at + 1u] : vec3(0.0);
            vec3 c = operands > 2u ? stack[at + 2u] : vec3(0.0);
            vec3 partial;
            float value = operation(i.op, i.value, a.x, b.x, c.x, partial);
            result = vec3(value, chained(partial.x, a.yz) + chained(partial.y, b.yz) + chained(partial.z, c.yz));
        }
        stack[at] = result;
        top = at + 1u;
    }
    return stack[0];
}

void main() {
    uint i = thread_index();
    if (i >= params.count) {
        return;
    }
    Sample place = LOAD(samples, i);
    if (place.detail != params.detail) {
        return;
    }
    Frame frame = frame_at(site_of_sample(place));
    Layer layer = LOAD(layers, params.layer);
    vec3 u = layer.texel_from_u.x * frame.u + layer.texel_from_u.y * frame.v + vec3(layer.texel_from_u.z, 0.0, 0.0);
    vec3 v = layer.texel_from_v.x * frame.u + layer.texel_from_v.y * frame.v + vec3(layer.texel_from_v.z, 0.0, 0.0);
    vec3 value = evaluate_jet(layer, u, v, frame.position, frame.normal);
    vec3 height = (value - vec3(layer.midlevel, 0.0, 0.0)) * layer.scale;
    add_jet(i, place, product(height, frame.direction), params.accumulate != 0u);
}
