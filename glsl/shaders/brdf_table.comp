#version 460
#extension GL_GOOGLE_include_directive : require
// What a surface reflects of light from everywhere, by roughness and angle of view (the split sum's second factor, Karis
// 2013). A thread per cell: rows of equal roughness, cells by the square root of the cosine, at the centres of texels.
#include "common.glsl"
#include "pages.glsl"
#include "trigonometry.glsl"
#include "hammersley.glsl"
#include "brdf.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;   // cells, side squared
    uint side;
    uint samples; // a power of two
} params;

// x, y: f0 * x + y is the directional albedo of single reflection; z: the cosine-weighted mean over light of (1 - v.h)^5.
PAGED(0, writeonly, vec3, brdf_table);

// Weight of a facet, and the cosine that light meets it under. Facets are drawn as the viewer sees them (Dupuy and Benyoub
// 2023), so that the weight is G2 / G1.
vec2 single(float alpha, vec2 view, float b, vec2 turn) {
    vec2 wide = normalize(vec2(alpha * view.x, view.y));
    float z = 1.0 - b * (1.0 + wide.y);
    float radius = sqrt(max(1.0 - z * z, 0.0));
    vec3 h = normalize(vec3(alpha * (radius * turn.y + wide.x), alpha * radius * turn.x, z + wide.y));
    float vh = max(dot(view, h.xz), 0.0);
    float nl = 2.0 * vh * h.z - view.y;
    if (nl <= 0.0) {
        return vec2(0.0, vh);
    }
    return vec2(visibility(alpha, view.y, nl) * 2.0 * nl * (view.y + masking(alpha * alpha, view.y)), vh);
}

// (1 - v.h)^5 for light drawn by its cosine.
float below(vec2 view, float b, vec2 turn) {
    float vl = view.x * sqrt(b) * turn.y + view.y * sqrt(1.0 - b);
    return grazing(sqrt(max(0.5 + 0.5 * vl, 0.0)));
}

void element(uint i) {
    vec2 centre = (vec2(i / params.side, i % params.side) + 0.5) / float(params.side);
    float alpha = max(centre.x * centre.x, MIN_ALPHA);
    float nv = centre.y * centre.y;
    vec2 view = vec2(sqrt(1.0 - nv * nv), nv);
    vec3 sum = vec3(0.0);
    uint samples = min(params.samples, 65536u);
    [[dont_unroll]] for (uint k = 0u; k < samples; ++k) {
        vec2 point = hammersley(k, samples);
        vec2 turn = sine_cosine(2.0 * PI * point.x);
        vec2 facet = single(alpha, view, point.y, turn);
        float share = grazing(facet.y);
        sum += vec3(facet.x * (1.0 - share), facet.x * share, below(view, point.y, turn));
    }
    STORE(brdf_table, i, sum / float(samples));
}

#include "batch.glsl"
