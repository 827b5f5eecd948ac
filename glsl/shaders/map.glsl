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

// Texel space is cut off where f32 tells no more than halves of texels apart.
const float FARTHEST_TEXEL = 4194303.0;

vec2 texel_space(const Layer layer, const vec2 uv) {
    precise vec2 p = vec2(
        layer.texel_from_u.x * uv.x + layer.texel_from_u.y * uv.y + layer.texel_from_u.z,
        layer.texel_from_v.x * uv.x + layer.texel_from_v.y * uv.y + layer.texel_from_v.z
    );
    return clamp(p, -FARTHEST_TEXEL, FARTHEST_TEXEL);
}

// Texel number of lattice coordinate i, whose remainder modulo the period is r.
uint texel_number(const MapAxis axis, const int i, const int r) {
    int inside = i < 0 || i > axis.top ? r : i;
    return uint(min(inside, axis.fold - inside));
}

// Texel numbers of the lattice coordinates first, first + 1 and first + 2.
uvec3 wrapped(const MapAxis axis, const int first) {
    ivec3 i = clamp(first + ivec3(0, 1, 2), axis.low, axis.high);
    int r = i.x - integer(floor(float(i.x) * axis.inverse_period)) * axis.period;
    r += r < 0 ? axis.period : 0;
    r -= r >= axis.period ? axis.period : 0;
    int next = r + 1 < axis.period ? r + 1 : 0;
    int last = next + 1 < axis.period ? next + 1 : 0;
    return uvec3(texel_number(axis, i.x, r), texel_number(axis, i.y, next), texel_number(axis, i.z, last));
}

// Texel number of lattice coordinate i.
uint texel_of(const MapAxis axis, const int lattice) {
    int i = clamp(lattice, axis.low, axis.high);
    int r = i - integer(floor(float(i) * axis.inverse_period)) * axis.period;
    r += r < 0 ? axis.period : 0;
    r -= r >= axis.period ? axis.period : 0;
    return texel_number(axis, i, r);
}
