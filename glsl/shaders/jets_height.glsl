// Adds one height layer to the jets of its detail's samples.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#include "frame.glsl"
#include "sample.glsl"
#include "jets.glsl"
#include "map.glsl"
#include "map_jet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint detail;
    uint layer;
    uint accumulate;
} params;

// Value and slopes by texel-space p.
vec3 map_jet(const Layer layer, const vec2 p) {
    vec2 corner = floor(p - 0.5);
    vec2 g = p - 0.5 - corner;
    uvec3 x = wrapped(layer.across, integer(corner.x)) + layer.first;
    uvec3 y = wrapped(layer.down, integer(corner.y)) * layer.row;
    vec3 sum = vec3(0.0);
    for (int row = 0; row < 3; ++row) {
        vec3 texel = vec3(LOAD_TEXEL(y[row] + x.x), LOAD_TEXEL(y[row] + x.y), LOAD_TEXEL(y[row] + x.z));
        vec2 a = tap_weights(0, g.x), b = tap_weights(1, g.x), d = tap_weights(2, g.x);
        vec2 across = vec2(dot(texel, vec3(a.x, b.x, d.x)), dot(texel, vec3(a.y, b.y, d.y)));
        vec2 down = tap_weights(row, g.y);
        sum += vec3(across.x * down.x, across.y * down.x, across.x * down.y);
    }
    return sum;
}

void element(uint i) {
    Sample place = LOAD(samples, i);
    if (place.detail != params.detail) {
        return;
    }
    Frame frame = frame_of(i, place);
    Layer layer = LOAD(layers, params.layer);
    vec3 x = texel_space_jet(layer.texel_from_u, frame.u, frame.v);
    vec3 y = texel_space_jet(layer.texel_from_v, frame.u, frame.v);
    vec3 h = map_jet(layer, vec2(x.x, y.x));
    vec3 height = layer.scale * vec3(h.x - layer.midlevel, h.y * x.yz + h.z * y.yz);
    add_jet(i, place, product(height, frame.direction), params.accumulate != 0u);
}

#include "batch.glsl"
