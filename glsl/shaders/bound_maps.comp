#version 460
// How far the map of one height layer is at most from what is linear between the corners of regions over few texels; of
// large ones see bound_large.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"
#include "bound_texels.glsl"
#include "bound_map.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint of_lines;  // 0 or 1
    uint at_texels; // 1: maps count at their texels alone
} params;

PAGED(0, readonly, MapPlaces, map_places);
PAGED(1, readonly, MapUse, map_uses);
PAGED(2, readonly, Layer, layers);
PAGED(3, readonly, uint, flags);   // 1: large
PAGED(4, , vec4, map_bounds);      // values at the corners, then heights there, and what is between

void element(uint i) {
    MapUse use = LOAD(map_uses, i);
    if (use.layer == NO_LAYER) {
        STORE(map_bounds, i, vec4(0.0));
        return;
    }
    if (LOAD(flags, i) != 0u) {
        return;
    }
    Layer layer = LOAD(layers, use.layer);
    vec3 values = LOAD(map_bounds, i).xyz;
    MapTriangle triangle = on_map(LOAD(map_places, i), values, params.of_lines != 0u);
    float between = 0.0;
    if (layer.scale != 0.0) {
        between = look(layer, triangle, Look(EVERYWHERE, params.of_lines != 0u, params.at_texels != 0u), 0.0, use.cap);
    }
    STORE(map_bounds, i, scaled(layer, values, between));
}

#include "batch.glsl"
