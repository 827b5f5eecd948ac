// What parts of a height layer's map are at most from planes near them, over ever larger blocks. The twin is
// `reference/bound/pyramid.rs`; structs are mirrored in layout/bound.rs.

// Over a block the map is in `range`, and is value + x · slope.x + y · slope.y + something in `rest`, with x and y in
// texels from its first. Least and greatest.
struct MapBlock {
    float value;
    vec2 slope;
    vec2 rest;
    vec2 range;
};

struct MapPyramid {
    ivec2 cells; // of the map's period
    uint first;  // of its blocks: level by level, the finest first, row by row
    uint top;    // the level of one block
};

// Cells along the side of a block of level 0, as a power of two.
const uint BLOCK_SHIFT = 3u;
// What f32 may take off a block's rest, as a share of its values.
const float REST_ROUNDING = 6e-7;

int block_width(const uint level) {
    return 1 << (BLOCK_SHIFT + level);
}

// Blocks across and down.
ivec2 level_size(const MapPyramid pyramid, const uint level) {
    return (pyramid.cells + block_width(level) - 1) >> int(BLOCK_SHIFT + level);
}

// The first block of a level.
uint level_first(const MapPyramid pyramid, const uint level) {
    uint first = pyramid.first;
    [[dont_unroll]] for (uint k = 0u; k < level; ++k) {
        ivec2 size = level_size(pyramid, k);
        first += uint(size.x * size.y);
    }
    return first;
}

float plane(const MapBlock block, const vec2 at) {
    precise float value = block.value + at.x * block.slope.x + at.y * block.slope.y;
    return value;
}

// With the plane through the middle of what the corners span: left and right above, left and right below.
MapBlock with_plane(const vec4 corners, const vec2 size) {
    precise vec2 across = corners.yw - corners.xz;
    precise vec2 down = corners.zw - corners.xy;
    precise vec2 slope = 0.5 * vec2(across.x + across.y, down.x + down.y) / size;
    return MapBlock(corners.x, slope, vec2(1e38, -1e38), vec2(1e38, -1e38));
}

vec2 merged(const vec2 a, const vec2 b) {
    return vec2(min(a.x, b.x), max(a.y, b.y));
}

// With a rest that rounding leaves nothing out of.
MapBlock widened(const MapBlock block, const vec2 size) {
    vec2 rise = abs(block.slope) * size;
    float values = max(abs(block.range.x), abs(block.range.y)) + abs(block.value) + rise.x + rise.y;
    MapBlock result = block;
    result.rest += REST_ROUNDING * values * vec2(-1.0, 1.0);
    return result;
}
