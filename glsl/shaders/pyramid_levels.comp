#version 460
// The blocks of a coarser level, each around up to four of the level before.
#include "common.glsl"
#include "pages.glsl"
#include "map_pyramid.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // blocks
    uint layer;
    uint level; // 1 or more
} params;

PAGED(0, readonly, MapPyramid, pyramids);
PAGED(1, , MapBlock, blocks);

// Up to two by two blocks of the finer level.
struct Parts {
    uint blocks; // the first of all
    int across;
    ivec2 first;
    ivec2 last;
    int width;
    ivec2 cells; // of the period
};

MapBlock part(const Parts parts, const ivec2 at) {
    return LOAD(blocks, parts.blocks + uint(at.y * parts.across + at.x));
}

// Cells of one of them.
vec2 size_of(const Parts parts, const ivec2 at) {
    return vec2(min((at + 1) * parts.width, parts.cells) - at * parts.width);
}

// A corner of them all: (0, 0) to (1, 1).
float corner(const Parts parts, const ivec2 which) {
    ivec2 at = min(parts.first + which, parts.last);
    return plane(part(parts, at), vec2(which) * size_of(parts, at));
}

void hold(inout MapBlock block, const Parts parts, const ivec2 at) {
    MapBlock own = part(parts, at);
    vec2 from = vec2((at - parts.first) * parts.width), size = size_of(parts, at);
    block.range = merged(block.range, own.range);
    [[dont_unroll]] for (int k = 0; k < 4; ++k) {
        vec2 place = vec2(k & 1, k >> 1) * size;
        precise float apart = plane(own, place) - plane(block, from + place);
        block.rest = merged(block.rest, apart + own.rest);
    }
}

void element(uint i) {
    MapPyramid pyramid = LOAD(pyramids, params.layer);
    uint finer = params.level - 1u;
    int across = level_size(pyramid, params.level).x;
    ivec2 finest = level_size(pyramid, finer);
    Parts parts;
    parts.blocks = level_first(pyramid, finer);
    parts.across = finest.x;
    parts.first = 2 * ivec2(int(i) % across, int(i) / across);
    parts.last = min(parts.first + 1, finest - 1);
    parts.width = block_width(finer);
    parts.cells = pyramid.cells;
    vec2 size = vec2(min((parts.last + 1) * parts.width, parts.cells) - parts.first * parts.width);
    vec4 corners = vec4(
        corner(parts, ivec2(0, 0)), corner(parts, ivec2(1, 0)), corner(parts, ivec2(0, 1)), corner(parts, ivec2(1, 1))
    );
    MapBlock block = with_plane(corners, size);
    [[dont_unroll]] for (int k = 0; k < 4; ++k) {
        ivec2 at = parts.first + ivec2(k & 1, k >> 1);
        if (all(lessThanEqual(at, parts.last))) {
            hold(block, parts, at);
        }
    }
    STORE(blocks, level_first(pyramid, params.level) + i, widened(block, size));
}

#include "batch.glsl"
