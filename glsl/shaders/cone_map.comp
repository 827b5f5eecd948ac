#version 460
// Cones of a level of heights: for every cell the widest cone, up to what the window tells, in which a ray that descends
// goes below the bilinear surface at most once, whatever place of the cell it starts above (after Policarpo and Oliveira
// 2007 and Ban et al. 2024). A cone is how many texels wide it is for each unit of height, from the surface upwards.
//
// A ray comes out of the surface only where heights fall along its way. So a cell B bounds the cone of a cell A where
// the heights of B fall for some way from A to B, by x / f of the places there, x being how far they are and f how much
// higher than where the cone stands: at least the distance of the cells over the difference of their heights, and at
// least 1 over the steepest slope on the way, and 1 over the greatest difference of slopes on it.
#include "common.glsl"
#include "pages.glsl"
#include "relief.glsl"
#include "tiled.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // texels
    uint wrap;  // as that of Relief
    float high; // no height is greater
    ReliefLevel level;
} params;

PAGED(0, , float, texels); // heights are read, cones written

const int WINDOW = 32;           // texels around a cell within which others are looked at
const float WIDEST = 1048576.0;  // of cells that nothing bounds
const float KEPT = 0.99999;      // more than rounding takes

// Heights side by side: two across a way along the rows or the columns of the level.
struct Pairs {
    bool by_rows;
    uvec2 across; // where the two are, without what is along
};

Pairs pairs_along(bool by_rows, ivec2 cell) {
    ivec2 size = ivec2(params.level.size);
    if (by_rows) {
        uint wrap = params.wrap >> 2;
        uvec2 rows = uvec2(tiled(cell.y, size.y, wrap), tiled(cell.y + 1, size.y, wrap));
        return Pairs(true, params.level.height_first + rows * params.level.size.x);
    }
    uint wrap = params.wrap & 3u;
    return Pairs(false, params.level.height_first + uvec2(tiled(cell.x, size.x, wrap), tiled(cell.x + 1, size.x, wrap)));
}

vec2 pair_at(Pairs pairs, int i) {
    ivec2 size = ivec2(params.level.size);
    uint along = pairs.by_rows
        ? uint(tiled(i, size.x, params.wrap & 3u))
        : uint(tiled(i, size.y, params.wrap >> 2)) * params.level.size.x;
    return vec2(LOAD_TEXEL(pairs.across.x + along), LOAD_TEXEL(pairs.across.y + along));
}

// Of a cell: at (0, 0), (1, 0), (0, 1) and (1, 1).
vec4 corners_of(bool by_rows, vec2 near, vec2 far) {
    return by_rows ? vec4(near.x, far.x, near.y, far.y) : vec4(near, far);
}

float least_of(vec4 h) {
    return min(min(h.x, h.y), min(h.z, h.w));
}

float greatest_of(vec4 h) {
    return max(max(h.x, h.y), max(h.z, h.w));
}

// Within a cell slopes change by its twist alone: along a way of length x by at most 2 |twist| / x and |twist| x, so
// that where heights fall again they are at most |twist| x / sqrt(2) up.
float own_cone(vec4 h) {
    float twist = abs(h.x - h.y - h.z + h.w);
    return twist > 0.0 ? min(1.41421356 / twist, WIDEST) : WIDEST;
}

// What a ring of cells says.
struct Ring {
    vec2 low;    // least and greatest slopes of all cells so far, height for each texel
    vec2 high;
    float least; // of distance over difference of height, of cells where heights fall
};

// Least product of numbers of two ranges.
float least_product(vec2 a, vec2 b) {
    return min(min(a.x * b.x, a.x * b.y), min(a.y * b.x, a.y * b.y));
}

void look_at(vec4 h, ivec2 away, float low, inout Ring ring) {
    vec2 along_x = vec2(h.y - h.x, h.w - h.z);
    vec2 along_y = vec2(h.z - h.x, h.w - h.y);
    ring.low = min(ring.low, vec2(min(along_x.x, along_x.y), min(along_y.x, along_y.y)));
    ring.high = max(ring.high, vec2(max(along_x.x, along_x.y), max(along_y.x, along_y.y)));
    float falls = least_product(along_x, vec2(away.x - 1, away.x + 1)) + least_product(along_y, vec2(away.y - 1, away.y + 1));
    float higher = greatest_of(h) - low;
    if (falls < 0.0 && higher > 0.0) {
        vec2 apart = vec2(max(abs(away) - 1, 0));
        ring.least = min(ring.least, length(apart) / higher);
    }
}

// The most that heights rise along a way, for each texel, before they fall at its end.
float rise_of(Ring ring) {
    return min(length(max(abs(ring.low), abs(ring.high))), length(ring.high - ring.low));
}

// Cells side by side, as many as told, the first so far away: neighbours share two heights.
void look_along(bool by_rows, ivec2 cell, ivec2 away, int count, float low, inout Ring ring) {
    Pairs pairs = pairs_along(by_rows, cell + away);
    int i = by_rows ? cell.x + away.x : cell.y + away.y;
    vec2 near = pair_at(pairs, i);
    [[dont_unroll]] for (int k = 0; k < count; ++k) {
        vec2 far = pair_at(pairs, i + k + 1);
        look_at(corners_of(by_rows, near, far), away + (by_rows ? ivec2(k, 0) : ivec2(0, k)), low, ring);
        near = far;
    }
}

// The cells that are r away.
void look_around(ivec2 cell, int r, float low, inout Ring ring) {
    look_along(true, cell, ivec2(-r, -r), 2 * r + 1, low, ring);
    look_along(true, cell, ivec2(-r, r), 2 * r + 1, low, ring);
    look_along(false, cell, ivec2(-r, 1 - r), 2 * r - 1, low, ring);
    look_along(false, cell, ivec2(r, 1 - r), 2 * r - 1, low, ring);
}

float cone_of(ivec2 cell) {
    Pairs pairs = pairs_along(true, cell);
    vec4 h = corners_of(true, pair_at(pairs, cell.x), pair_at(pairs, cell.x + 1));
    float low = least_of(h);
    float cone = own_cone(h);
    Ring ring = Ring(vec2(WIDEST), vec2(-WIDEST), WIDEST);
    look_at(h, ivec2(0), low, ring);
    int r = 1;
    [[dont_unroll]] for (; r <= WINDOW && float(r - 1) < cone * (params.high - low); ++r) {
        ring.least = WIDEST;
        look_around(cell, r, low, ring);
        if (ring.least < WIDEST) {
            cone = min(cone, max(ring.least, 1.0 / rise_of(ring)));
        }
    }
    if (r > WINDOW) {
        // What lies beyond is at least as far away.
        cone = min(cone, float(WINDOW) / (params.high - low));
    }
    return KEPT * cone;
}

void element(uint i) {
    uint width = params.level.size.x;
    uint at = params.level.cone_first + i;
    LOAD_TEXEL(at) = cone_of(ivec2(i % width, i / width));
}

#include "batch.glsl"
