#version 460
// How far the map of one height layer is at most from what is linear along each side of regions of many texels. Beyond the
// border of a clamped map, where it is straight one way or both, nothing between the sides is farther off.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"
#include "bound_texels.glsl"
#include "bound_map.glsl"
#include "bound_border.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;     // sides: three for each region
    uint first;     // place in `large`
    uint of_lines;  // 0 or 1
    uint at_texels; // 1: maps count at their texels alone
} params;

PAGED(0, readonly, MapPlaces, map_places);
PAGED(1, readonly, MapUse, map_uses);
PAGED(2, readonly, Layer, layers);
PAGED(3, readonly, uint, large);      // numbers of regions
PAGED(4, readonly, vec4, map_bounds); // values at the corners
PAGED(6, , uint, side_bounds);        // of each region, bits of an f32 >= 0

// The lattice lines that are met next, of those of the map.
vec2 limited(const vec2 next, const vec2 along, const Window domain) {
    vec2 up = mix(max(next, domain.low), vec2(FAR), greaterThan(next, domain.high));
    vec2 down = mix(min(next, domain.high), vec2(-FAR), lessThan(next, domain.low));
    return mix(down, up, greaterThan(along, vec2(0.0)));
}

// Along the part of a side before `stop`, and that after `again`, piece by piece.
float along_side(const Layer layer, const ivec2 origin, const MapSide side, const vec2 inside, const float cap) {
    vec2 along = side.along.xy;
    Window domain = domain_of(layer, origin);
    vec2 next = limited(first_lines(side.from.xy, along), along, domain);
    uint most = uint(min(abs(along.x) + abs(along.y) + 16.0, MOST_LINES));
    float at = 0.0, end = inside.x, worst = 0.0;
    [[dont_unroll]] for (uint n = 0u; n < most && worst <= cap; ++n) {
        if (at >= end) {
            if (end == 1.0 || inside.y >= 1.0) {
                break;
            }
            at = inside.y;
            end = 1.0;
            next = limited(first_lines(side.from.xy + at * along, along), along, domain);
        }
        vec2 to = lines_at(side, next);
        float stop = clamp(min(to.x, to.y), at, end);
        worst = max(worst, piece(layer, origin, side, at, stop));
        next = limited(next + mix(vec2(0.0), sign(along), lessThanEqual(to, vec2(stop))), along, domain);
        at = stop;
    }
    return worst;
}

void element(uint i) {
    uint k = i / 3u;
    uint region = LOAD(large, params.first + k);
    MapUse use = LOAD(map_uses, region);
    Layer layer = LOAD(layers, use.layer);
    MapTriangle t = on_map(LOAD(map_places, region), LOAD(map_bounds, region).xyz, params.of_lines != 0u);
    uint from = i % 3u, to = from == 2u ? 0u : from + 1u;
    if (params.of_lines != 0u && from != 0u) {
        return;
    }
    MapSide side;
    side.from = vec3(t.x[from], t.y[from], t.value[from]);
    side.along = vec3(t.x[to], t.y[to], t.value[to]) - side.from;
    // What is not gone along.
    vec2 inside = vec2(1.0);
    if (params.at_texels != 0u) {
        vec2 part = part_of(side, domain_of(layer, t.origin));
        inside = part.x > part.y ? vec2(1.0) : part;
    }
    float worst = along_side(layer, t.origin, side, inside, use.cap);
    atomicMax(ELEMENT(side_bounds, k), floatBitsToUint(worst));
}

#include "batch.glsl"
