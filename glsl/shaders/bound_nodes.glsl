// The nodes of a search over a map that may repeat: the blocks of one period, and above them squares of ever more
// periods. Include after bound_plane.glsl.

// All periods that a triangle touches.
struct Ground {
    MapPyramid pyramid;
    ivec2 origin; // of the triangle's coordinates
    ivec2 start;  // the first period, on each axis
    ivec2 period; // of the blocks that are open
};

// Nodes of a level, the last included.
struct Nodes {
    uint level;
    ivec2 first;
    ivec2 last;
};

const Nodes NO_NODES = Nodes(0u, ivec2(0), ivec2(-1));

// What a node covers.
Window window_of(const Ground ground, const uint level, const ivec2 at) {
    ivec2 cells = ground.pyramid.cells, low, high;
    if (level >= ground.pyramid.top) {
        uint more = level - ground.pyramid.top;
        low = (ground.start + (at << int(more))) * cells - ground.origin;
        high = low + (cells << int(more));
    } else {
        ivec2 start = ground.period * cells - ground.origin;
        low = start + at * block_width(level);
        high = min(low + block_width(level), start + cells);
    }
    return Window(vec2(low), vec2(high));
}

// What a node above level 0 is made of.
Nodes parts_of(const Ground ground, const uint level, const ivec2 at) {
    ivec2 first = level == ground.pyramid.top ? ivec2(0) : 2 * at;
    ivec2 last = first + 1;
    if (level <= ground.pyramid.top) {
        last = min(last, level_size(ground.pyramid, level - 1u) - 1);
    }
    return Nodes(level - 1u, first, last);
}

// The block that bounds a node.
uint block_number(const MapPyramid pyramid, const uint level, const ivec2 at) {
    if (level >= pyramid.top) {
        return level_first(pyramid, pyramid.top);
    }
    return level_first(pyramid, level) + uint(at.y * level_size(pyramid, level).x + at.x);
}
