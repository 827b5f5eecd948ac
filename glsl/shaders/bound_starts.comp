#version 460
// Where the searches over regions of many texels begin. The twin is `reference/bound/search.rs`, with `linear.rs`.
#include "common.glsl"
#include "pages.glsl"
#include "map.glsl"
#include "bound_texels.glsl"
#include "bound_map.glsl"
#include "bound_border.glsl"
#include "map_pyramid.glsl"
#include "bound_plane.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;    // regions
    uint first;    // place in `large`
    uint of_lines; // 0 or 1
    float cap;     // what the bound may come to, over all layers
    uint layers;   // at most of a region
} params;

PAGED(0, readonly, MapPlaces, map_places);
PAGED(1, readonly, MapUse, map_uses);
PAGED(2, readonly, Layer, layers);
PAGED(3, readonly, uint, large);      // numbers of regions
PAGED(4, readonly, vec4, map_bounds); // values at the corners
PAGED(6, readonly, MapPyramid, pyramids);
PAGED(7, readonly, MapBlock, blocks);
PAGED(8, writeonly, MapSearch, searches);

// A search ends so near the truth, as a share of the cap; what it finds is not below the truth.
const float RESOLUTION = 1.0 / 32.0;
// Nor does it go on for less than this share of the map's values.
const float LITTLE = 8e-6;
// Corners whose triangle is narrower than this share of its sides count as on a line.
const float NARROW = 1e-3;
// What f32 may take off the difference of planes, as a share of their values.
const float PLANE_ROUNDING = 1e-6;

// Along the longest of three sides, whose sum is 0.
vec2 slope_along_longest(const vec2 p, const vec2 q, const float up, const float uq) {
    vec2 d = p, r = q - p;
    float u = up;
    if (dot(q, q) > dot(d, d)) {
        d = q;
        u = uq;
    }
    if (dot(r, r) > dot(d, d)) {
        d = r;
        u = uq - up;
    }
    float square = dot(d, d);
    return square > 0.0 ? u / square * d : vec2(0.0);
}

// The slope of the plane that a triangle lies near, and how far at most it is from it.
vec3 plane_of(const MapTriangle t, const float values) {
    vec2 p = vec2(t.x.y - t.x.x, t.y.y - t.y.x), q = vec2(t.x.z - t.x.x, t.y.z - t.y.x);
    float up = t.value.y - t.value.x, uq = t.value.z - t.value.x;
    float area = p.x * q.y - p.y * q.x;
    vec2 slope = slope_along_longest(p, q, up, uq);
    if (abs(area) > NARROW * length(p) * length(q)) {
        slope = vec2(up * q.y - uq * p.y, uq * p.x - up * q.x) / area;
    }
    Window around = around_of(t);
    vec2 rise = abs(slope) * (around.high - around.low);
    float rounding = PLANE_ROUNDING * (values + greatest(abs(t.value)) + rise.x + rise.y);
    return vec3(slope, max(abs(up - dot(slope, p)), abs(uq - dot(slope, q))) + rounding);
}

// The cross products of places inside and each side lie between these.
void inside_of(const MapTriangle t, out vec3 low, out vec3 high) {
    vec3 dx = t.x.yzx - t.x, dy = t.y.yzx - t.y;
    vec3 third = dx * (t.y.zxy - t.y) - dy * (t.x.zxy - t.x);
    vec3 size = abs(dx) + abs(dy);
    vec3 rim = 2.0 * RIM * size * (1.0 + greatest(size));
    low = min(third, 0.0) - rim;
    high = max(third, 0.0) + rim;
}

ivec2 floored_quotient(const ivec2 a, const ivec2 b) {
    ivec2 below = -((b - 1 - a) / b);
    return ivec2(a.x < 0 ? below.x : a.x / b.x, a.y < 0 ? below.y : a.y / b.y);
}

// The node over all periods touched.
void place_first_node(inout MapSearch search, const Layer layer, const MapPyramid pyramid, const ivec2 origin) {
    ivec2 low = ivec2(floor(search.around.low)) + origin, high = ivec2(floor(search.around.high)) + origin;
    bvec2 clamped = bvec2(is_clamped(layer.across), is_clamped(layer.down));
    search.period = mix(floored_quotient(low, pyramid.cells), ivec2(0), clamped);
    ivec2 more = mix(floored_quotient(high, pyramid.cells), ivec2(0), clamped) - search.period;
    // Of 0, findMSB is -1.
    search.level = pyramid.top + uint(findMSB(max(max(more.x, more.y), 0)) + 1);
}

float resolution(const float scale, const float cap, const float values) {
    float little = LITTLE * values;
    if (cap >= NO_CAP) {
        return little;
    }
    return max(little, RESOLUTION / float(params.layers) * min(params.cap / scale, cap));
}

void element(uint i) {
    uint region = LOAD(large, params.first + i);
    MapUse use = LOAD(map_uses, region);
    Layer layer = LOAD(layers, use.layer);
    MapPyramid pyramid = LOAD(pyramids, use.layer);
    MapTriangle t = on_map(LOAD(map_places, region), LOAD(map_bounds, region).xyz, params.of_lines != 0u);
    Window around = around_of(t), domain = domain_of(layer, t.origin);
    vec2 range = abs(LOAD(blocks, level_first(pyramid, pyramid.top)).range);
    float values = max(range.x, range.y);
    vec3 flat_part = plane_of(t, values);
    MapSearch search;
    search.around = Window(max(around.low, domain.low), min(around.high, domain.high));
    search.slope = flat_part.xy;
    search.apart = flat_part.z;
    search.near = resolution(abs(layer.scale), use.cap, values);
    inside_of(t, search.low, search.high);
    place_first_node(search, layer, pyramid, t.origin);
    STORE(searches, i, search);
}

#include "batch.glsl"
