#version 460
// How far the map of one height layer is at most from what is linear over regions of many texels, at their texels: depth
// first over blocks, of each the part first that may be farthest off. The twin is `reference/bound/search.rs`, which goes
// through sides and texels at once and always opens the block that may be farthest off.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"
#include "bound_texels.glsl"
#include "bound_map.glsl"
#include "map_pyramid.glsl"
#include "bound_plane.glsl"
#include "bound_nodes.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;     // regions
    uint first;     // place in `large`
    uint of_lines;  // 0 or 1
    uint at_texels; // 1: maps count at their texels alone
} params;

PAGED(0, readonly, MapPlaces, map_places);
PAGED(1, readonly, MapUse, map_uses);
PAGED(2, readonly, Layer, layers);
PAGED(3, readonly, uint, large);       // numbers of regions
PAGED(4, , vec4, map_bounds);          // values at the corners, then heights there, and what is between
PAGED(6, readonly, uint, side_bounds); // bits of f32
PAGED(7, readonly, MapPyramid, pyramids);
PAGED(8, readonly, MapBlock, blocks);
PAGED(9, readonly, MapSearch, searches);

// A search that has opened so many nodes takes what is left as it may be at most.
const uint MOST_STEPS = 1u << 14;
// Three nodes are left of each level: 12 of blocks, 24 of periods. What has no room counts as it may be at most.
const uint MOST_OPEN = 112u;

// Bound, level and x, y of nodes; the last is opened first.
uvec3 open[MOST_OPEN];
uint open_count;
// What no node needs to be opened for, and what nodes that were not may come to.
float enough;
float closed;

float open_bound(const uint k) {
    return uintBitsToFloat(open[k].x);
}

// Puts a node among the open ones of its parent, which begin at `first`, unless it is near enough.
void push(const MapTriangle t, const MapSearch search, const Ground ground, const uint first, const uint level, const ivec2 at) {
    Window whole = window_of(ground, level, at);
    Window window = Window(max(whole.low, search.around.low), min(whole.high, search.around.high));
    if (any(greaterThan(window.low, window.high)) || is_outside(t, search, window)) {
        return;
    }
    bool by_plane = level <= ground.pyramid.top;
    MapBlock block = LOAD(blocks, block_number(ground.pyramid, level, at));
    float bound = block_bound(t, search, block, by_plane, whole.low, window);
    if (bound <= enough || open_count == MOST_OPEN) {
        closed = max(closed, bound);
        return;
    }
    uint place = open_count++;
    [[dont_unroll]] for (; place > first && open_bound(place - 1u) > bound; --place) {
        open[place] = open[place - 1u];
    }
    open[place] = uvec3(floatBitsToUint(bound), level << 24 | uint(at.x), uint(at.y));
}

void push_all(const MapTriangle t, const MapSearch search, const Ground ground, const Nodes nodes) {
    uint first = open_count;
    [[dont_unroll]] for (int k = 0; k < 4; ++k) {
        ivec2 at = nodes.first + ivec2(k & 1, k >> 1);
        if (all(lessThanEqual(at, nodes.last))) {
            push(t, search, ground, first, nodes.level, at);
        }
    }
}

// Looks for what is farther off than `worst`.
float greatest_difference(const MapTriangle t, const MapSearch search, const MapUse use, const Layer layer, float worst) {
    Ground ground = Ground(LOAD(pyramids, use.layer), t.origin, search.period, search.period);
    Nodes next = Nodes(search.level, ivec2(0), ivec2(0));
    Window leaf;
    bool looks = false;
    [[dont_unroll]] for (uint n = 0u; n < MOST_STEPS + MOST_OPEN; ++n) {
        if (looks) {
            worst = at_texels(layer, t, leaf, worst, use.cap);
        }
        enough = max(worst, min(worst + search.near, 0.9999 * use.cap));
        push_all(t, search, ground, next);
        if (worst > use.cap || open_count == 0u) {
            break;
        }
        uvec3 node = open[--open_count];
        float bound = uintBitsToFloat(node.x);
        uint level = node.y >> 24;
        ivec2 at = ivec2(node.y & 0xffffffu, node.z);
        bool is_near = bound <= enough || n >= MOST_STEPS;
        closed = is_near ? max(closed, bound) : closed;
        looks = !is_near && level == 0u;
        // What is open below belongs to periods that come after all of this one.
        ground.period = level == ground.pyramid.top ? search.period + at : ground.period;
        leaf = window_of(ground, level, at);
        next = is_near || looks ? NO_NODES : parts_of(ground, level, at);
    }
    return max(worst, closed);
}

void element(uint i) {
    open_count = 0u;
    closed = 0.0;
    uint region = LOAD(large, params.first + i);
    MapUse use = LOAD(map_uses, region);
    vec3 values = LOAD(map_bounds, region).xyz;
    Layer layer = LOAD(layers, use.layer);
    MapTriangle t = on_map(LOAD(map_places, region), values, params.of_lines != 0u);
    float worst = uintBitsToFloat(LOAD(side_bounds, i));
    if (worst <= use.cap && (params.of_lines == 0u || params.at_texels != 0u)) {
        worst = greatest_difference(t, LOAD(searches, i), use, layer, worst);
    }
    STORE(map_bounds, region, scaled(layer, values, worst));
}

#include "batch.glsl"
