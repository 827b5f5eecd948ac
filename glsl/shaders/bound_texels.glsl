// How far a bilinear map is at most from what is linear between three places: exact but for rounding. The twin is
// `reference/bound/texels.rs`. Include after pages.glsl and map.glsl.

PAGED(5, readonly, float, texels);

// Three places on a map: lattice coordinates less `origin`, so that small triangles on large maps keep their digits, and
// the map's values there.
struct MapTriangle {
    vec3 x;
    vec3 y;
    vec3 value;
    ivec2 origin;
};

// Share of a triangle's extent that rounding may move a crossing by: a texel so near outside counts as inside.
const float RIM = 5e-7;
// f32 tells no more texels apart along a triangle.
const float MOST_LINES = 16777216.0;

float greatest(const vec3 v) {
    return max(v.x, max(v.y, v.z));
}

float texel_at(const uint row, const uint column) {
    return LOAD(texels, row + column);
}

// Texels (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
vec4 cell_texels(const Layer layer, const ivec2 cell) {
    uvec2 x = uvec2(texel_of(layer.across, cell.x), texel_of(layer.across, cell.x + 1));
    uvec2 y = uvec2(texel_of(layer.down, cell.y), texel_of(layer.down, cell.y + 1)) * layer.row + layer.first;
    return vec4(texel_at(y.x, x.x), texel_at(y.x, x.y), texel_at(y.y, x.x), texel_at(y.y, x.y));
}

float bilinear(const vec4 t, const vec2 f) {
    precise float above = t.x * (1.0 - f.x) + t.y * f.x;
    precise float below = t.z * (1.0 - f.x) + t.w * f.x;
    precise float value = above * (1.0 - f.y) + below * f.y;
    return value;
}

// A side from `from`, along `along`; z is the value.
struct MapSide {
    vec3 from;
    vec3 along;
};

float difference(const MapSide side, const vec4 t, const vec2 cell, const float at) {
    vec3 place = side.from + at * side.along;
    return bilinear(t, place.xy - cell) - place.z;
}

// Between two crossings with the lattice the difference is a parabola: its ends, and where it is level.
float piece(const Layer layer, const ivec2 origin, const MapSide side, const float start, const float end) {
    float middle = 0.5 * (start + end);
    vec2 cell = floor(side.from.xy + middle * side.along.xy);
    vec4 t = cell_texels(layer, origin + ivec2(integer(cell.x), integer(cell.y)));
    float f0 = difference(side, t, cell, start);
    float fm = difference(side, t, cell, middle);
    float f1 = difference(side, t, cell, end);
    float bend = 0.5 * (f0 + f1) - fm;
    float slope = 0.5 * (f1 - f0);
    float worst = max(abs(f0), abs(f1));
    if (abs(slope) < 2.0 * abs(bend)) {
        float level = -0.5 * slope / bend;
        worst = max(worst, abs(fm + level * (slope + level * bend)));
    }
    return worst;
}

// The lattice lines that are met first.
vec2 first_lines(const vec2 from, const vec2 along) {
    return mix(ceil(from) - 1.0, floor(from) + 1.0, greaterThan(along, vec2(0.0)));
}

// Along the sides, piece by piece; of a line only the first.
float along_sides(const Layer layer, const MapTriangle triangle, const bool line, const float cap) {
    vec3 x = triangle.x, y = triangle.y, value = triangle.value;
    vec3 crossed = abs(x - x.yzx) + abs(y - y.yzx) + 4.0;
    uint most = uint(min(crossed.x + crossed.y + crossed.z, MOST_LINES));
    float worst = 0.0;
    float start = 1.0;
    uint sides = line ? 1u : 3u;
    MapSide side;
    vec2 next;
    [[dont_unroll]] for (uint n = 0u; n < most && worst <= cap; ++n) {
        if (start >= 1.0) {
            if (sides == 0u) {
                break;
            }
            --sides;
            side.from = vec3(x.x, y.x, value.x);
            side.along = vec3(x.y, y.y, value.y) - side.from;
            next = first_lines(side.from.xy, side.along.xy);
            start = 0.0;
            x = x.yzx;
            y = y.yzx;
            value = value.yzx;
        }
        vec2 to = vec2(1.0);
        to.x = side.along.x == 0.0 ? 1.0 : (next.x - side.from.x) / side.along.x;
        to.y = side.along.y == 0.0 ? 1.0 : (next.y - side.from.y) / side.along.y;
        float first = min(to.x, to.y);
        float end = clamp(first, start, 1.0);
        worst = max(worst, piece(layer, triangle.origin, side, start, end));
        next += mix(vec2(0.0), sign(side.along.xy), lessThanEqual(to, vec2(end)));
        start = first >= 1.0 ? 1.0 : end;
    }
    return worst;
}

// Where a row enters and leaves a triangle (x), and what is linear there (y).
void cross_row(const MapTriangle triangle, const float row, const float rim, out vec2 start, out vec2 end) {
    vec3 to_y = triangle.y.yzx;
    vec3 down = to_y - triangle.y;
    start = vec2(1e30, 0.0);
    end = vec2(-1e30, 0.0);
    // A level side is met at its start, and at its end as the next side's start.
    for (uint k = 0u; k < 3u; ++k) {
        if (row < min(triangle.y[k], to_y[k]) - rim || row > max(triangle.y[k], to_y[k]) + rim) {
            continue;
        }
        float at = down[k] == 0.0 ? 0.0 : clamp((row - triangle.y[k]) / down[k], 0.0, 1.0);
        uint next = k == 2u ? 0u : k + 1u;
        vec2 from = vec2(triangle.x[k], triangle.value[k]);
        vec2 met = from + at * (vec2(triangle.x[next], triangle.value[next]) - from);
        start = met.x < start.x ? met : start;
        end = met.x > end.x ? met : end;
    }
}

// At the texels inside, row by row.
float at_texels(const Layer layer, const MapTriangle triangle, const float cap) {
    vec3 y = triangle.y;
    vec2 low = vec2(min(triangle.x.x, min(triangle.x.y, triangle.x.z)), min(y.x, min(y.y, y.z)));
    vec2 high = vec2(greatest(triangle.x), greatest(y));
    float rim = RIM * (1.0 + max(high.x - low.x, high.y - low.y));
    vec2 crossed = high - low + 3.0;
    uint most = uint(min(crossed.x * crossed.y, 2.0e9));
    float row = ceil(low.y - rim) - 1.0;
    vec2 start = vec2(0.0), end = vec2(0.0);
    float x = 1.0, slope = 0.0;
    uint row_first = 0u;
    float worst = 0.0;
    [[dont_unroll]] for (uint n = 0u; n < most && worst <= cap; ++n) {
        if (x > end.x + rim) {
            row += 1.0;
            if (row > high.y + rim) {
                break;
            }
            cross_row(triangle, row, rim, start, end);
            slope = end.x > start.x ? (end.y - start.y) / (end.x - start.x) : 0.0;
            x = ceil(start.x - rim);
            row_first = texel_of(layer.down, triangle.origin.y + integer(row)) * layer.row + layer.first;
        }
        if (x <= end.x + rim) {
            float linear = start.y + (x - start.x) * slope;
            float texel = texel_at(row_first, texel_of(layer.across, triangle.origin.x + integer(x)));
            worst = max(worst, abs(texel - linear));
            x += 1.0;
        }
    }
    return worst;
}

// The greatest difference; where it exceeds `cap`, some difference that does. A line is the side from the first place to
// the second.
float greatest_difference(const Layer layer, MapTriangle triangle, const bool line, const bool texels_only, const float cap) {
    float worst = texels_only ? 0.0 : along_sides(layer, triangle, line, cap);
    if (worst > cap || (line && !texels_only)) {
        return worst;
    }
    if (line) {
        triangle.x.z = triangle.x.y;
        triangle.y.z = triangle.y.y;
        triangle.value.z = triangle.value.y;
    }
    return max(worst, at_texels(layer, triangle, cap));
}
