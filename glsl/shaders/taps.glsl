// Taps of slopes by central differences over one texel, which are the bilinear surface's slopes averaged over a texel and so
// continuous.

// Weights of three neighbouring texels, the middle one nearest: interpolated value (x), slope (y). `g` is
// the offset from the nearest texel, plus 0.5.
vec2 tap_weights(const int k, const float g) {
    vec3 value = vec3(max(0.5 - g, 0.0), 0.0, max(g - 0.5, 0.0));
    value.y = 1.0 - value.x - value.z;
    vec3 slope = vec3(g - 1.0, 1.0 - 2.0 * g, g);
    return vec2(value[k], slope[k]);
}
