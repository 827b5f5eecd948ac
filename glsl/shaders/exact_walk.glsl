// The way of a piece over nodes and cells of a map. Include after exact_piece.glsl and exact_leaf.glsl.

// Where a march begins, nodes are so much smaller than the way, as a power of two.
const int START_BELOW = 3;
const int ENDLESS = 1 << 28;

struct Walk {
    float t;
    ivec2 tile;  // its first cell; what is clamped is one endless tile
    ivec2 cell;  // number in the tile
    int level;   // of the node: 2^level cells a side, at the end of a tile as few as it leaves
    int most;    // the highest level that is used
    uint first;  // of the level's bounds
    bool above;
};

// Along each axis: as many cells as are before the next tile.
ivec2 ends_of(Trip trip) {
    ivec2 size = ivec2(trip.level.size);
    return ivec2((trip.relief.wrap & 3u) == 0u ? size.x : ENDLESS, (trip.relief.wrap >> 2) == 0u ? size.y : ENDLESS);
}

ivec2 nodes_at(Trip trip, int level) {
    return (ivec2(trip.level.size) + (1 << level) - 1) >> level;
}

uint count_at(Trip trip, int level) {
    ivec2 nodes = nodes_at(trip, level);
    return uint(nodes.x * nodes.y);
}

// Moves to the cell at t, at most a tile away.
void move_to(Piece piece, ivec2 ends, inout Walk walk, float t) {
    walk.t = t;
    vec2 cell = cell_at(piece, t);
    ivec2 at = ivec2(integer(cell.x), integer(cell.y)) - walk.tile;
    ivec2 over = ivec2(greaterThanEqual(at, ends)) - ivec2(lessThan(at, ivec2(0))) * ivec2(lessThan(ends, ivec2(ENDLESS)));
    walk.tile += over * ends;
    walk.cell = at - over * ends;
}

Walk walk_from(Trip trip, Piece piece, ivec2 ends, bool above) {
    vec2 way = abs(piece.direction);
    float travel = way.x + way.y;
    ivec2 size = ivec2(trip.level.size);
    Walk walk;
    walk.above = above;
    walk.most = travel < params.setting ? 0 : findMSB(uint(max(size.x, size.y) * 2 - 1));
    walk.level = clamp((floatBitsToInt(travel) >> 23) - 127 - START_BELOW, 0, walk.most);
    walk.first = 0u;
    [[dont_unroll]] for (int level = 0; level < walk.level; ++level) {
        walk.first += count_at(trip, level);
    }
    vec2 tile = floor(floor(piece.origin) / vec2(ends));
    walk.tile = ivec2(integer(tile.x), integer(tile.y)) * ends * ivec2(lessThan(ends, ivec2(ENDLESS)));
    move_to(piece, ends, walk, 0.0);
    return walk;
}

// Goes on to what is next; a level up where that belongs to another node there.
void pass_by(Trip trip, Piece piece, ivec2 ends, inout Walk walk, float leaves) {
    ivec2 tile = walk.tile;
    ivec2 above = walk.cell >> (walk.level + 1);
    move_to(piece, ends, walk, leaves);
    bool stays = tile == walk.tile && above == (walk.cell >> (walk.level + 1));
    if (!stays && walk.level < walk.most) {
        walk.first += count_at(trip, walk.level);
        walk.level += 1;
    }
}

// Passes a node by, or goes below it as far along as its height allows.
void visit_node(Trip trip, Piece piece, ivec2 ends, inout Walk walk) {
    ivec2 nodes = nodes_at(trip, walk.level);
    ivec2 node = walk.cell >> walk.level;
    ivec2 at = clamp(node, ivec2(0), nodes - 1);
    float bound = LOAD_TEXEL(trip.level.bound_first + walk.first + uint(at.y * nodes.x + at.x));
    ivec2 line = min((node + ivec2(forward_of(piece))) << walk.level, ends);
    vec2 crossings = crossing(piece, vec2(walk.tile + line));
    float leaves = min(crossings.x, crossings.y);
    float clear = clear_until(piece, bound, walk.t);
    walk.above = walk.above || clear > walk.t;
    if (clear >= leaves) {
        pass_by(trip, piece, ends, walk, leaves);
    } else {
        move_to(piece, ends, walk, max(walk.t, clear));
        walk.level -= 1;
        walk.first -= count_at(trip, walk.level);
    }
}

// The four corners of the cell.
vec4 corners_here(Trip trip, ivec2 ends, Walk walk) {
    ivec2 last = ivec2(trip.level.size) - 1;
    ivec2 near = clamp(walk.cell, ivec2(0), last);
    ivec2 next = walk.cell + 1;
    ivec2 far = mix(clamp(next, ivec2(0), last), ivec2(0), equal(next, ends));
    uint low = trip.level.height_first + uint(near.y * (last.x + 1));
    uint high = trip.level.height_first + uint(far.y * (last.x + 1));
    return vec4(LOAD_TEXEL(low + near.x), LOAD_TEXEL(low + far.x), LOAD_TEXEL(high + near.x), LOAD_TEXEL(high + far.x));
}

// Over the cell, from t = `enters` on.
Gap gap_of(Piece piece, vec2 cell, vec4 h, float enters, float leaves) {
    precise vec2 p = (piece.origin - cell) + piece.direction * enters;
    precise vec2 slope = h.yz - h.x;
    precise float twist = (h.x - h.y) + (h.w - h.z);
    precise float c = (piece.z + piece.fall * enters) - (h.x + (slope.x + twist * p.y) * p.x + slope.y * p.y);
    precise vec2 falls = (slope + twist * p.yx) * piece.direction;
    precise float b = piece.fall - (falls.x + falls.y);
    precise float a = -twist * piece.direction.x * piece.direction.y;
    return Gap(a, b, c, leaves - enters);
}

// The t at which the surface is met in the cell, or NOWHERE, after which the walk is at the next one.
float visit_cell(Trip trip, Piece piece, ivec2 ends, inout Walk walk, bvec2 outermost) {
    vec2 cell = vec2(walk.tile + walk.cell);
    vec2 forward = forward_of(piece);
    vec2 entered = crossing(piece, cell + 1.0 - forward);
    vec2 left = crossing(piece, cell + forward);
    float enters = max(max(entered.x, entered.y), 0.0);
    float leaves = min(min(left.x, left.y), 1.0);
    Gap gap = gap_of(piece, cell, corners_here(trip, ends, walk), enters, leaves);
    bool falls = piece.fall < 0.0;
    walk.above = walk.above || (outermost.x && falls && enters <= 0.0 && gap.c >= -piece.slack);
    float after = met(gap, walk.above);
    if (after >= 0.0) {
        return min(enters + after, leaves);
    }
    if (walk.above && outermost.y && falls && leaves >= 1.0 && gap_at_end(gap) <= piece.slack) {
        return 1.0;
    }
    pass_by(trip, piece, ends, walk, leaves);
    return NOWHERE;
}
