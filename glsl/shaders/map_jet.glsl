// Maps with derivatives: the bilinear value, and slopes by central differences over one texel, which are
// the bilinear surface's slopes averaged over a texel and so continuous. The twin is `reference/map.rs`.
// Include after map.glsl.

PAGED(8, readonly, Layer, layers);
PAGED(9, readonly, float, texels);

// Weights of three neighbouring texels, the middle one nearest: interpolated value (x), slope (y). `g` is
// the offset from the nearest texel, plus 0.5.
vec2 tap_weights(const int k, const float g) {
    vec3 value = vec3(max(0.5 - g, 0.0), 0.0, max(g - 0.5, 0.0));
    value.y = 1.0 - value.x - value.z;
    vec3 slope = vec3(g - 1.0, 1.0 - 2.0 * g, g);
    return vec2(value[k], slope[k]);
}

// Texel-space coordinates as jets.
vec3 texel_space_jet(const vec3 row, const vec3 u, const vec3 v) {
    precise float value = row.x * u.x + row.y * v.x + row.z;
    return vec3(clamp(value, -FARTHEST_TEXEL, FARTHEST_TEXEL), row.x * u.yz + row.y * v.yz);
}
