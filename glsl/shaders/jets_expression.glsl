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
#define JETS
#include "expression.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint detail;
    uint layer;
    uint accumulate;
} params;

PAGED(8, readonly, Layer, layers);

void element(uint i) {
    Sample place = LOAD(samples, i);
    if (place.detail != params.detail) {
        return;
    }
    Frame frame = frame_of(i, place);
    Layer layer = LOAD(layers, params.layer);
    vec3 u = layer.texel_from_u.x * frame.u + layer.texel_from_u.y * frame.v + vec3(layer.texel_from_u.z, 0.0, 0.0);
    vec3 v = layer.texel_from_v.x * frame.u + layer.texel_from_v.y * frame.v + vec3(layer.texel_from_v.z, 0.0, 0.0);
    mat3 p = transpose(frame.position);
    mat3 n = transpose(frame.normal);
    vec3 value = evaluate(layer.first, layer.row, vec3[8](u, v, p[0], p[1], p[2], n[0], n[1], n[2]));
    vec3 height = (value - vec3(layer.midlevel, 0.0, 0.0)) * layer.scale;
    add_jet(i, place, product(height, frame.direction), params.accumulate != 0u);
}

#include "batch.glsl"
