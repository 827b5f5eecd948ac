// Filtering of maps in f32, from storage buffers. The twin is `reference/map.rs`.

// How lattice coordinates along one axis become texels: clamped to [low, high], then, outside [0, top],
// reduced modulo the period, then folded (mirror).
struct MapAxis {
    int low;
    int high;
    int period;
    int top;
    int fold;
    float inverse_period;
};

// One layer of a detail. Maps: `texel_from_*` are rows of the affine map from (u, v, 1) to texel space,
// where texel i lies at i. Expressions: the rows give (u', v') and `first`, `row` are the code's range.
struct Layer {
    uint kind;
    uint first; // of the layer's floats, or instructions
    uint row;   // texels in a row, or instructions
    float scale;
    float midlevel;
    vec3 texel_from_u;
    vec3 texel_from_v;
    MapAxis across;
    MapAxis down;
};

const uint HEIGHT = 0u;
const uint VECTOR_TANGENT = 1u;
const uint VECTOR_OBJECT = 2u;
const uint EXPRESSION = 3u;

// Texel space is cut off where f32 no longer tells texels apart.
const float FARTHEST_TEXEL = 8388608.0;

vec2 texel_space(const Layer layer, const vec2 uv) {
    precise vec2 p = vec2(
        layer.texel_from_u.x * uv.x + layer.texel_from_u.y * uv.y + layer.texel_from_u.z,
        layer.texel_from_v.x * uv.x + layer.texel_from_v.y * uv.y + layer.texel_from_v.z
    );
    return clamp(p, -FARTHEST_TEXEL, FARTHEST_TEXEL);
}

int wrapped(const MapAxis axis, int i) {
    i = clamp(i, axis.low, axis.high);
    int r = i - int(floor(float(i) * axis.inverse_period)) * axis.period;
    r += r < 0 ? axis.period : 0;
    r -= r >= axis.period ? axis.period : 0;
    r = i < 0 || i > axis.top ? r : i;
    return min(r, axis.fold - r);
}
