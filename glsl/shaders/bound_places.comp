#version 460
// Where regions lie on the map of one height layer, the map's values at their corners, and which lie over many texels.
#include "common.glsl"
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "pages.glsl"
#include "map.glsl"
#include "bound.glsl"
#include "bound_facet.glsl"
#include "bound_region.glsl"
#include "bound_texels.glsl"
#include "bound_map.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint of_lines;     // 0 or 1
    uint layer;        // number among those of the region's detail
    uint stride;       // texel places of a vertex
    float cap;         // what the bound may come to: above it, any value above it does
    float most_texels; // about so many texels and crossings has a region that is not large
} params;

PAGED(3, readonly, Layer, layers);
PAGED(4, readonly, TexelPlace, texel_places);
PAGED(6, writeonly, MapPlaces, map_places);
PAGED(7, writeonly, MapUse, map_uses);
PAGED(8, writeonly, vec4, map_bounds); // values at the corners, and 0
PAGED(9, writeonly, uint, flags);      // 1: large

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
    ivec2 wholes[3];
    vec2 rests[3];
    [[dont_unroll]] for (uint k = 0u; k < 3u; ++k) {
        wholes[k] = place_of(p, units[k], rests[k]);
    }
    // In the middle, where whole numbers are smallest.
    ivec2 low = min(wholes[0], min(wholes[1], wholes[2])), high = max(wholes[0], max(wholes[1], wholes[2]));
    result.origin = (low + high) >> 1;
    [[dont_unroll]] for (uint k = 0u; k < 3u; ++k) {
        vec2 more = floor(rests[k]);
        vec2 place = vec2(wholes[k] - result.origin) + rests[k];
        result.x[k] = place.x;
        result.y[k] = place.y;
        result.value[k] = bilinear(cell_texels(layer, wholes[k] + ivec2(more)), rests[k] - more);
    }
    return result;
}

float range(const vec3 v) {
    return greatest(v) - least(v);
}

// How many texels and crossings are looked at, about: half the box, and its sides.
float cost(const MapTriangle triangle) {
    float width = range(triangle.x), height = range(triangle.y);
    return 0.5 * width * height + 8.0 * (width + height);
}

// What the difference may come to, unscaled: a little more, lest rounding bring what is above the cap back to it.
float cap_of(const Region region, const float scale) {
    float size = scale * region.least;
    return size > 0.0 ? min(params.cap / size * 1.00001, NO_CAP) : NO_CAP;
}

void element(uint i) {
    Region region = region_of(i, params.of_lines != 0u);
    STORE(flags, i, 0u);
    if (params.layer >= region.layers.y - region.layers.x) {
        STORE(map_uses, i, MapUse(NO_LAYER, 0.0));
        return;
    }
    uint number = region.layers.x + params.layer;
    Layer layer = LOAD(layers, number);
    MapTriangle triangle = map_triangle(region, layer);
    if (params.of_lines != 0u) {
        triangle.x.z = triangle.x.y;
        triangle.y.z = triangle.y.y;
    }
    float scale = abs(layer.scale);
    STORE(map_places, i, MapPlaces(triangle.x, triangle.y, triangle.origin));
    STORE(map_uses, i, MapUse(number, cap_of(region, scale)));
    STORE(map_bounds, i, vec4(triangle.value, 0.0));
    if (scale > 0.0 && cost(triangle) > params.most_texels) {
        STORE(flags, i, 1u);
    }
}

#include "batch.glsl"
