// How steep the bilinear heights are. Needs `relief_levels`, `texels`; include after tiled.glsl and taps.glsl.

float relief_height(Relief relief, ReliefLevel level, ivec2 texel) {
    ivec2 size = ivec2(level.size);
    int x = tiled(texel.x, size.x, relief.wrap & 3u);
    int y = tiled(texel.y, size.y, relief.wrap >> 2);
    uint at = level.height_first + uint(y * size.x + x);
    return LOAD_TEXEL(at);
}

// Mesh-local units per texel of the level, along x and y.
vec2 slope_at(Relief relief, uint level_index, vec2 place) {
    ReliefLevel level = LOAD(relief_levels, relief.level_first + level_index);
    ivec2 cell = ivec2(floor(place));
    vec2 f = place - floor(place);
    float a = relief_height(relief, level, cell);
    float b = relief_height(relief, level, cell + ivec2(1, 0));
    float c = relief_height(relief, level, cell + ivec2(0, 1));
    float d = relief_height(relief, level, cell + ivec2(1, 1));
    return vec2(mix(b - a, d - c, f.y), mix(c - a, d - b, f.x));
}

// The same averaged over a texel, as displaced surfaces have it for their normals.
vec2 smooth_slope_at(Relief relief, uint level_index, vec2 place) {
    ReliefLevel level = LOAD(relief_levels, relief.level_first + level_index);
    ivec2 nearest = ivec2(floor(place + 0.5));
    vec2 g = place + 0.5 - floor(place + 0.5);
    vec2 slope = vec2(0.0);
    for (int y = 0; y < 3; ++y) {
        vec2 down = tap_weights(y, g.y);
        for (int x = 0; x < 3; ++x) {
            vec2 across = tap_weights(x, g.x);
            float height = relief_height(relief, level, nearest + ivec2(x - 1, y - 1));
            slope += height * vec2(across.y * down.x, across.x * down.y);
        }
    }
    return slope;
}

// Mesh-local units.
float height_at_place(Relief relief, uint level_index, vec2 place) {
    ReliefLevel level = LOAD(relief_levels, relief.level_first + level_index);
    ivec2 cell = ivec2(floor(place));
    vec2 f = place - floor(place);
    float top = mix(relief_height(relief, level, cell), relief_height(relief, level, cell + ivec2(1, 0)), f.x);
    float bottom =
        mix(relief_height(relief, level, cell + ivec2(0, 1)), relief_height(relief, level, cell + ivec2(1, 1)), f.x);
    return mix(top, bottom, f.y);
}
