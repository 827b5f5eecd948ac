// Chances of stochastic transparency (Enderton et al. 2010). The twin is `reference/masked.rs`.
#include "keys.glsl"

// Within (0, 1), for one sample of one triangle: a surface is kept where its alpha is above.
float threshold_of(ivec2 pixel, int s, uint id) {
    uint key = mixed(mixed(mixed(uint(pixel.x)) ^ uint(pixel.y)) ^ id);
    key = mixed(key + uint(s) * 0x9E3779B9u);
    // 23 bits and a half: no rounding, neither 0 nor 1.
    return (float(key >> 9) + 0.5) / 8388608.0;
}
