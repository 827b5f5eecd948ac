#version 460
#extension GL_GOOGLE_include_directive : require
// How many tiles of the slab the box of each record meets: a thread per record. A scan of the counts gives
// the (record, tile) pairs their places.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "coverage.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    ivec2 slab_px;
    ivec2 slab_size_px;
} params;

PAGED(0, readonly, ivec4, records);
PAGED(1, writeonly, uint, counts);

#include "triangle_64.glsl"
#include "tile_grid.glsl"

const uint NO_TRIANGLE = 0xFFFFFFFFu;

void element(uint i) {
    uint tiles = 0u;
    if (uint(LOAD(records, i * 3u).w) != NO_TRIANGLE) {
        ivec4 box = tiles_of(load_record(i));
        tiles = uint((box.z - box.x + 1) * (box.w - box.y + 1));
    }
    STORE(counts, i, tiles);
}

#include "batch.glsl"
