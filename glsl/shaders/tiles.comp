#version 460
#extension GL_GOOGLE_include_directive : require
// Expands (record, tile) pairs: a thread per pair finds its record in the scanned tile counts and drops
// tiles that lie wholly outside the triangle.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "coverage.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint pair_first;
    uint record_count;
    ivec2 slab_px;
    ivec2 slab_size_px;
} params;

PAGED(0, readonly, ivec4, records);
// Exclusive sums of the tile counts.
PAGED(1, readonly, uint, offsets);
// Record, and tile as x | y << 16; the record is NO_RECORD where there is nothing to draw.
PAGED(2, writeonly, uvec2, pairs);

#include "triangle_64.glsl"
#include "tile_grid.glsl"

const uint NO_RECORD = 0xFFFFFFFFu;

// The last record whose pairs begin at or before `pair`: records without tiles are skipped.
uint find_record(uint pair) {
    uint low = 0u;
    uint high = params.record_count - 1u;
    for (uint k = 0u; k < 32u && low < high; ++k) {
        uint middle = low + (high - low + 1u) / 2u;
        if (LOAD(offsets, middle) <= pair) {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    return low;
}

bool meets_tile(Triangle64 t, ivec2 low) {
    ivec2 high = low + TILE_PX * 256;
    for (int k = 0; k < 3; ++k) {
        ivec2 best = ivec2(t.edge[k].y < 0 ? high.x : low.x, t.edge[k].x > 0 ? high.y : low.y);
        if (edge_at(t, k, best) < 0l) {
            return false;
        }
    }
    return true;
}

void element(uint i) {
    uint pair = params.pair_first + i;
    uint record = find_record(pair);
    Triangle64 t = load_record(record);
    ivec4 tiles = tiles_of(t);
    uint columns = uint(tiles.z - tiles.x + 1);
    uint place = pair - LOAD(offsets, record);
    uvec2 tile = uvec2(tiles.xy) + uvec2(place % columns, place / columns);
    bool meets = meets_tile(t, (ivec2(tile) * TILE_PX + params.slab_px) * 256);
    STORE(pairs, i, uvec2(meets ? record : NO_RECORD, tile.x | tile.y << 16));
}

#include "batch.glsl"
