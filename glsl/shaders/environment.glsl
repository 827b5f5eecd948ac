// Light from infinitely far away, by direction. The map is equirectangular as three.js and Khronos' viewer have it: d is at
// u = 1/2 + atan2(d.z, d.x) / 2 pi, v = acos(d.y) / pi, so that its middle is +x and +z a quarter to the right of it.
// Include after pages.glsl, texel_pair.glsl, trigonometry.glsl; needs in scope
//   PAGED(b, readonly, uvec4, environment_levels);      first texel (even), width, height, 0: the map, its mips, irradiance
//   PAGED(b, readonly, TexelPair, environment_texels);  linear RGB

#define ENVIRONMENT_TEXEL(I) (ELEMENT(environment_texels, (I) >> 1).texel[(I) & 1u].rgb)

const float HALF_TURN = 3.14159265358979;

// Where the map shows a direction of any length.
vec2 place_of(vec3 d) {
    return vec2(
        0.5 + arc_tangent2(d.z, d.x) * (0.5 / HALF_TURN), arc_tangent2(length(d.xz), d.y) * (1.0 / HALF_TURN));
}

// Beyond a pole the same row goes on half a turn farther.
vec3 environment_row(uvec4 level, float u, int y) {
    int width = int(level.y);
    int height = int(level.z);
    bool beyond = y < 0 || y >= height;
    y = y < 0 ? -1 - y : (beyond ? 2 * height - 1 - y : y);
    float x = (u + (beyond ? 0.5 : 0.0)) * float(width) - 0.5;
    int left = integer(floor(x));
    int right = left + 1;
    left = left < 0 ? left + width : (left >= width ? left - width : left);
    right = right >= width ? right - width : right;
    uint row = level.x + uint(y * width);
    uint left_texel = row + uint(clamp(left, 0, width - 1));
    uint right_texel = row + uint(clamp(right, 0, width - 1));
    return mix(ENVIRONMENT_TEXEL(left_texel), ENVIRONMENT_TEXEL(right_texel), x - floor(x));
}

// Bilinear, texel i of n at (i + 1/2) / n.
vec3 environment_at(uvec4 level, vec2 place) {
    float y = place.y * float(level.z) - 0.5;
    int top = clamp(integer(floor(y)), -1, int(level.z) - 1);
    return mix(environment_row(level, place.x, top), environment_row(level, place.x, top + 1), y - floor(y));
}

// By two of the `mips` first levels; `level` counts from the map itself.
vec3 environment_trilinear(vec2 place, float level, uint mips) {
    level = clamp(level, 0.0, float(mips - 1u));
    uint finer = uint(level);
    vec3 value = environment_at(LOAD(environment_levels, finer), place);
    float t = level - float(finer);
    return t > 0.0 ? mix(value, environment_at(LOAD(environment_levels, finer + 1u), place), t) : value;
}

// What arrives from `d` over `footprint` radians: the mip level has texels as high as that (Blinn and Newell 1976 see one
// place; Williams 1983 filters).
vec3 environment_mirror(vec3 d, float footprint, uint mips) {
    float texels = footprint * float(LOAD(environment_levels, 0u).z) / HALF_TURN;
    return environment_trilinear(place_of(d), log2(max(texels, 1.0)), mips);
}
