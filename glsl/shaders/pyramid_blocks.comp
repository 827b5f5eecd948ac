#version 460
// The finest blocks of a height layer's map: a plane near the texels of 8 by 8 cells, and how far they are from it.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"
#include "map_pyramid.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // blocks
    uint layer;
} params;

PAGED(0, readonly, Layer, layers);
PAGED(1, readonly, MapPyramid, pyramids);
PAGED(2, readonly, float, texels);
PAGED(3, writeonly, MapBlock, blocks);

float texel(const Layer layer, const ivec2 at) {
    return LOAD_TEXEL(layer.first + texel_of(layer.down, at.y) * layer.row + texel_of(layer.across, at.x));
}

// Where the map goes on, its period once more: at its ends a map that repeats from node to node may hold another texel
// the first time.
ivec2 once_more(const Layer layer, const ivec2 cells, const ivec2 at) {
    bvec2 goes_on = bvec2(layer.across.high != layer.across.top, layer.down.high != layer.down.top);
    bvec2 ends = bvec2(at.x == 0 || at.x == cells.x, at.y == 0 || at.y == cells.y);
    return ivec2(goes_on.x && ends.x ? cells.x : 0, goes_on.y && ends.y ? cells.y : 0);
}

// Makes room for the texels that may lie at a place.
void hold(inout MapBlock block, const Layer layer, const ivec2 cells, const ivec2 low, const ivec2 at) {
    float flat_value = plane(block, vec2(at - low));
    ivec2 more = once_more(layer, cells, at);
    [[dont_unroll]] for (int k = 0; k < 4; ++k) {
        ivec2 step = ivec2(k & 1, k >> 1);
        if (any(greaterThan(step, more))) {
            continue;
        }
        float value = texel(layer, at + step * more);
        block.rest = merged(block.rest, vec2(value - flat_value));
        block.range = merged(block.range, vec2(value));
    }
}

void element(uint i) {
    Layer layer = LOAD(layers, params.layer);
    MapPyramid pyramid = LOAD(pyramids, params.layer);
    int across = level_size(pyramid, 0u).x;
    ivec2 low = block_width(0u) * ivec2(int(i) % across, int(i) / across);
    ivec2 high = min(low + block_width(0u), pyramid.cells);
    vec2 size = vec2(high - low);
    vec4 corners = vec4(
        texel(layer, low), texel(layer, ivec2(high.x, low.y)), texel(layer, ivec2(low.x, high.y)), texel(layer, high)
    );
    MapBlock block = with_plane(corners, size);
    [[dont_unroll]] for (int y = low.y; y <= high.y; ++y) {
        [[dont_unroll]] for (int x = low.x; x <= high.x; ++x) {
            hold(block, layer, pyramid.cells, low, ivec2(x, y));
        }
    }
    STORE(blocks, pyramid.first + i, widened(block, size));
}

#include "batch.glsl"
