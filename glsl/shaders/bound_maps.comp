#version 460
// What one height layer does over regions: its heights at their corners, and how far it is at most from what is linear in
// between.
#include "common.glsl"
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "pages.glsl"
#include "map.glsl"
#include "bound.glsl"
#include "bound_facet.glsl"
#include "bound_region.glsl"
#include "bound_texels.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint of_lines;  // 0 or 1
    uint layer;     // number among those of the region's detail
    uint stride;    // texel places of a vertex
    uint at_texels; // 1: maps count at their texels alone
    float cap;      // what the bound may come to: above it, any value above it does
} params;

PAGED(3, readonly, Layer, layers);
PAGED(4, readonly, TexelPlace, texel_places);
PAGED(6, writeonly, vec4, map_bounds); // heights at the corners, and what is between
PAGED(7, readonly, float, reliefs);    // by how much the values of each layer's map differ at most, unscaled

// A region over more texels counts as off by all the relief, and so is split where that matters: one thread goes over them.
const float MOST_TEXELS = 2097152.0;
// Nor over so many where the values differ by less than this share of what is allowed.
const float MANY_TEXELS = 4096.0;
const float LITTLE = 0.25;
const float NO_CAP = 1e30;

TexelPlace texel_place(const uint av) {
    return LOAD(texel_places, av * params.stride + params.layer);
}

// Texel space of a corner: whole lattice coordinates, and the rest in [0, 2).
ivec2 place_of(const TexelPlace p[3], const uvec3 units, out vec2 rest) {
    i64vec2 sum = i64vec2(p[1].whole - p[0].whole) * int64_t(units.y) + i64vec2(p[2].whole - p[0].whole) * int64_t(units.z);
    ivec2 whole = ivec2(sum >> 24);
    uvec2 part = uvec2(sum) & (WHOLE - 1u);
    vec3 shares = vec3(units) * SHARE;
    rest = vec2(part) * SHARE + shares.x * p[0].rest + shares.y * p[1].rest + shares.z * p[2].rest;
    return p[0].whole + whole;
}

MapTriangle map_triangle(const Region region, const Layer layer) {
    TexelPlace p[3] = TexelPlace[3](texel_place(region.av.x), texel_place(region.av.y), texel_place(region.av.z));
    MapTriangle result;
    uvec3 units[3] = uvec3[3](region.a, region.b, region.c);
    [[dont_unroll]] for (uint k = 0u; k < 3u; ++k) {
        vec2 rest;
        ivec2 whole = place_of(p, units[k], rest);
        if (k == 0u) {
            result.origin = whole;
        }
        vec2 more = floor(rest);
        vec2 place = vec2(whole - result.origin) + rest;
        result.x[k] = place.x;
        result.y[k] = place.y;
        result.value[k] = bilinear(cell_texels(layer, whole + ivec2(more)), rest - more);
    }
    return result;
}

float range(const vec3 v) {
    return greatest(v) - min(v.x, min(v.y, v.z));
}

// How many texels and crossings are looked at, about: half the box, and its sides.
float cost(const MapTriangle triangle) {
    float width = range(triangle.x), height = range(triangle.y);
    return 0.5 * width * height + 8.0 * (width + height);
}

void element(uint i) {
    Region region = region_of(i, params.of_lines != 0u);
    if (params.layer >= region.layers.y - region.layers.x) {
        STORE(map_bounds, i, vec4(0.0));
        return;
    }
    Layer layer = LOAD(layers, region.layers.x + params.layer);
    MapTriangle triangle = map_triangle(region, layer);
    vec3 heights = layer.scale * (triangle.value - layer.midlevel);
    float scale = abs(layer.scale);
    float size = scale * region.least;
    // A little more, lest rounding bring what is above the cap back to it.
    float cap = size > 0.0 ? min(params.cap / size * 1.00001, NO_CAP) : NO_CAP;
    float relief = LOAD(reliefs, region.layers.x + params.layer);
    float texels_cost = cost(triangle);
    float between = relief;
    if (scale > 0.0 && texels_cost <= MOST_TEXELS && (texels_cost <= MANY_TEXELS || cap == NO_CAP || relief > LITTLE * cap)) {
        between = greatest_difference(layer, triangle, params.of_lines != 0u, params.at_texels != 0u, cap);
    }
    between *= scale;
    STORE(map_bounds, i, vec4(heights, between));
}

#include "batch.glsl"
