// Adds one vector layer to the jets of its detail's samples.
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

// Value and slopes of the three channels by texel-space p.
mat3 map_jet(const Layer layer, const vec2 p) {
    vec2 corner = floor(p - 0.5);
    vec2 g = p - 0.5 - corner;
    uvec3 x = wrapped(layer.across, integer(corner.x));
    uvec3 y = wrapped(layer.down, integer(corner.y)) * layer.row;
    mat3 sum = mat3(0.0);
    for (int k = 0; k < 9; ++k) {
        int row = k / 3;
        int column = k - 3 * row;
        uint at = layer.first + 3u * (y[row] + x[column]);
        vec3 texel;
        for (uint channel = 0u; channel < 3u; ++channel) {
            texel[channel] = LOAD_TEXEL(at + channel);
        }
        vec2 across = tap_weights(column, g.x);
        vec2 down = tap_weights(row, g.y);
        sum += mat3(across.x * down.x * texel, across.y * down.x * texel, across.x * down.y * texel);
    }
    return sum;
}

// Unit tangent and bitangent, made perpendicular to the normal.
void tangents_at(const Site site, const mat3 normal, out mat3 tangent, out mat3 bitangent) {
    vec4 t0 = tangent_of(site.av.x), t1 = tangent_of(site.av.y), t2 = tangent_of(site.av.z);
    mat3 t = jet(site.b, t0.xyz, t1.xyz, t2.xyz);
    mat3 q = t - product(dot_jet(normal, t), normal);
    tangent = dot(q[0], q[0]) > MIN_TANGENT_SQUARE ? product(inverse_length(q, 1e-12), q)
                                                   : mat3(any_perpendicular(normal[0]), vec3(0.0), vec3(0.0));
    float handedness = dot(site.b, vec3(t0.w, t1.w, t2.w)) < 0.0 ? -1.0 : 1.0;
    bitangent = handedness * cross_jet(normal, tangent);
}

void element(uint i) {
    Sample place = LOAD(samples, i);
    if (place.detail != params.detail) {
        return;
    }
    Site site = site_of_sample(place);
    Frame frame = frame_of(i, place);
    Layer layer = LOAD(layers, params.layer);
    vec3 x = texel_space_jet(layer.texel_from_u, frame.u, frame.v);
    vec3 y = texel_space_jet(layer.texel_from_v, frame.u, frame.v);
    mat3 h = map_jet(layer, vec2(x.x, y.x));
    mat3 vector = layer.scale * mat3(h[0] - layer.midlevel, h[1] * x.y + h[2] * y.y, h[1] * x.z + h[2] * y.z);
    if (layer.kind == VECTOR_TANGENT) {
        mat3 tangent, bitangent;
        tangents_at(site, frame.normal, tangent, bitangent);
        mat3 rows = transpose(vector);
        vector = product(rows[0], tangent) + product(rows[1], bitangent) + product(rows[2], frame.direction);
    }
    add_jet(i, place, vector, params.accumulate != 0u);
}

#include "batch.glsl"
