// How far blocks of a map are at most from what is linear over a triangle, and what lies outside it. The twin is
// `reference/bound/linear.rs`. Include after bound_texels.glsl and map_pyramid.glsl.

// Where a search begins.
struct MapSearch {
    Window around;  // what of texel space the triangle can have to do with
    vec2 slope;     // of the plane through the triangle's first corner
    float apart;    // how far at most from it the triangle is, with what rounding adds
    float near;     // to the truth, unscaled: near enough
    vec3 low;       // between these the cross products of places inside and a side lie, side by side
    vec3 high;
    ivec2 period;   // the first that is touched
    uint level;     // of the node over all periods touched
};

vec3 cross_products(const MapTriangle t, const vec2 at) {
    return (t.x.yzx - t.x) * (at.y - t.y) - (t.y.yzx - t.y) * (at.x - t.x);
}

// Whether all of the window lies on the far side of a side.
bool is_outside(const MapTriangle t, const MapSearch search, const Window window) {
    vec2 half_size = 0.5 * (window.high - window.low);
    vec3 middle = cross_products(t, window.low + half_size);
    vec3 around = abs(t.y.yzx - t.y) * half_size.x + abs(t.x.yzx - t.x) * half_size.y;
    return any(lessThan(middle + around, search.low)) || any(greaterThan(middle - around, search.high));
}

// How far at most a block that begins at `first` is from the triangle over part of it; `by_plane`: not by its range alone.
float block_bound(
    const MapTriangle t,
    const MapSearch search,
    const MapBlock block,
    const bool by_plane,
    const vec2 first,
    const Window window
) {
    vec2 half_size = 0.5 * (window.high - window.low);
    vec2 middle = window.low + half_size;
    float value = t.value.x + dot(search.slope, middle - vec2(t.x.x, t.y.x));
    float bound = max(block.range.y - value, value - block.range.x) + dot(abs(search.slope), half_size);
    if (by_plane) {
        float apart = plane(block, middle - first) - value;
        float spread = dot(abs(block.slope - search.slope), half_size);
        bound = min(bound, max(apart + block.rest.y, -(apart + block.rest.x)) + spread);
    }
    return bound + search.apart;
}
