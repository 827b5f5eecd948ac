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

// Part of texel space, its sides included; coordinates as those of the triangle.
struct Window {
    vec2 low;
    vec2 high;
};

// What is looked at.
struct Look {
    Window window;
    bool line;   // only the side from the first place to the second counts
    bool texels; // not along sides
};

const float FAR = 1e30;
const Window EVERYWHERE = Window(vec2(-FAR), vec2(FAR));

float greatest(const vec3 v) {
    return max(v.x, max(v.y, v.z));
}

float least(const vec3 v) {
    return min(v.x, min(v.y, v.z));
}

float texel_at(const uint row, const uint column) {
    return LOAD_TEXEL(row + column);
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

// Beyond the border of a clamped map a place may be far from the cell, whose texels are then the same.
float difference(const MapSide side, const vec4 t, const vec2 cell, const float at) {
    vec3 place = side.from + at * side.along;
    vec2 f = place.xy - cell;
    float above = t.x + f.x * (t.y - t.x), below = t.z + f.x * (t.w - t.z);
    return above + f.y * (below - above) - place.z;
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

// Where a side enters and leaves a window; where it stays outside the former is greater.
vec2 part_of(const MapSide side, const Window window) {
    vec2 from = side.from.xy, along = side.along.xy;
    bvec2 level = equal(along, vec2(0.0));
    vec2 by = mix(along, vec2(1.0), level);
    vec2 low = (window.low - from) / by, high = (window.high - from) / by;
    vec2 outside = mix(vec2(0.0), vec2(FAR), notEqual(clamp(from, window.low, window.high), from));
    vec2 enter = mix(min(low, high), outside, level), leave = mix(max(low, high), vec2(FAR), level);
    return vec2(max(0.0, max(enter.x, enter.y)), min(1.0, min(leave.x, leave.y)));
}

// Where a side meets lines.
vec2 lines_at(const MapSide side, const vec2 lines) {
    bvec2 level = equal(side.along.xy, vec2(0.0));
    return mix((lines - side.from.xy) / mix(side.along.xy, vec2(1.0), level), vec2(FAR), level);
}

// The lattice lines that are met next.
vec2 first_lines(const vec2 from, const vec2 along) {
    return mix(ceil(from) - 1.0, floor(from) + 1.0, greaterThan(along, vec2(0.0)));
}

// Along the sides within the window, piece by piece.
float along_sides(const Layer layer, const MapTriangle triangle, const Look what, float worst, const float cap) {
    vec3 x = triangle.x, y = triangle.y, value = triangle.value;
    vec3 crossed = abs(x - x.yzx) + abs(y - y.yzx) + 4.0;
    uint most = uint(min(crossed.x + crossed.y + crossed.z, MOST_LINES));
    vec2 part = vec2(1.0);
    uint sides = what.line ? 1u : 3u;
    MapSide side;
    vec2 next;
    [[dont_unroll]] for (uint n = 0u; n < most && worst <= cap; ++n) {
        if (part.x >= part.y) {
            if (sides == 0u) {
                break;
            }
            --sides;
            side.from = vec3(x.x, y.x, value.x);
            side.along = vec3(x.y, y.y, value.y) - side.from;
            part = part_of(side, what.window);
            next = first_lines(side.from.xy + part.x * side.along.xy, side.along.xy);
            x = x.yzx;
            y = y.yzx;
            value = value.yzx;
        }
        if (part.x < part.y) {
            vec2 to = lines_at(side, next);
            float end = clamp(min(to.x, to.y), part.x, part.y);
            worst = max(worst, piece(layer, triangle.origin, side, part.x, end));
            next += mix(vec2(0.0), sign(side.along.xy), lessThanEqual(to, vec2(end)));
            part.x = end;
        }
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

Window around_of(const MapTriangle triangle) {
    return Window(vec2(least(triangle.x), least(triangle.y)), vec2(greatest(triangle.x), greatest(triangle.y)));
}

// At the texels of the window inside, row by row.
float at_texels(const Layer layer, const MapTriangle triangle, const Window window, float worst, const float cap) {
    Window around = around_of(triangle);
    vec2 extent = around.high - around.low;
    float rim = RIM * (1.0 + max(extent.x, extent.y));
    vec2 low = max(around.low, window.low), high = min(around.high, window.high);
    vec2 crossed = max(high - low, 0.0) + 3.0;
    uint most = uint(min(crossed.x * crossed.y, 2.0e9));
    float row = ceil(low.y - rim) - 1.0;
    vec2 start = vec2(0.0), end = vec2(0.0);
    float x = 1.0, last = 0.0, slope = 0.0;
    uint row_first = 0u;
    [[dont_unroll]] for (uint n = 0u; n < most && worst <= cap; ++n) {
        if (x > last) {
            row += 1.0;
            if (row > high.y + rim) {
                break;
            }
            cross_row(triangle, row, rim, start, end);
            slope = end.x > start.x ? (end.y - start.y) / (end.x - start.x) : 0.0;
            x = ceil(max(start.x, low.x) - rim);
            last = min(end.x, high.x) + rim;
            row_first = texel_of(layer.down, triangle.origin.y + integer(row)) * layer.row + layer.first;
        }
        if (x <= last) {
            float linear = start.y + (x - start.x) * slope;
            float texel = texel_at(row_first, texel_of(layer.across, triangle.origin.x + integer(x)));
            worst = max(worst, abs(texel - linear));
            x += 1.0;
        }
    }
    return worst;
}

// The greatest of `worst` and the differences there; where it exceeds `cap`, some difference that does.
float look(const Layer layer, const MapTriangle triangle, const Look what, float worst, const float cap) {
    if (!what.texels) {
        worst = along_sides(layer, triangle, what, worst, cap);
    }
    if (worst > cap || (what.line && !what.texels)) {
        return worst;
    }
    return at_texels(layer, triangle, what.window, worst, cap);
}
