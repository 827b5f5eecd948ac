// Elementary functions in f32 that give the same bits on every device: no built-in sine, exponential or
// logarithm is exact enough or equal everywhere. Polynomials by Moshier (Cephes, single precision) and
// Abramowitz & Stegun 4.4.49. Kept short: drivers compile all of it into every interpreter.

#define NOT_A_NUMBER uintBitsToFloat(0x7fc00000u)
#define INFINITY uintBitsToFloat(0x7f800000u)

#include "trigonometry.glsl"

float exp2_of(const float x) {
    float within = clamp(x, -150.0, 129.0);
    precise float whole = floor(within + 0.5);
    precise float f = within - whole;
    precise float p = 1.0 + f * (6.931472028550421e-1 + f * (2.402264791363012e-1 + f * (5.550332471162809e-2
        + f * (9.618437357674640e-3 + f * (1.339887440266574e-3 + f * 1.535336188319500e-4)))));
    return ldexp(ldexp(p, int(whole) / 2), int(whole) - int(whole) / 2);
}

float log2_of(const float x) {
    if (!(x > 0.0)) {
        return x == 0.0 ? -INFINITY : NOT_A_NUMBER;
    }
    // Mantissa in [√½, √2).
    int e = int(floatBitsToUint(x) - 0x3f3504f3u) >> 23;
    precise float m = uintBitsToFloat(floatBitsToUint(x) - (uint(e) << 23)) - 1.0;
    precise float z = m * m;
    precise float p = (((((((7.0376836292e-2 * m - 1.1514610310e-1) * m + 1.1676998740e-1) * m - 1.2420140846e-1) * m
        + 1.4249322787e-1) * m - 1.6668057665e-1) * m + 2.0000714765e-1) * m - 2.4999993993e-1) * m + 3.3333331174e-1;
    precise float y = m * z * p - 0.5 * z;
    precise float log2_m = ((y * 0.44269504088896340 + m * 0.44269504088896340) + y) + m;
    return float(e) + log2_m;
}

// x^n for |n| <= 31 by squaring.
float power_integer(const float x, const int n) {
    precise float result = 1.0;
    precise float square = x;
    for (int left = abs(n); left > 0; left >>= 1) {
        result *= (left & 1) == 1 ? square : 1.0;
        square *= square;
    }
    return n < 0 ? 1.0 / result : result;
}

uint noise_hash(const ivec3 p) {
    uvec3 v = uvec3(p) * 1664525u + 1013904223u;
    for (int k = 0; k < 2; ++k) {
        v.x += v.y * v.z;
        v.y += v.z * v.x;
        v.z += v.x * v.y;
        v ^= v >> 16u;
    }
    return v.x;
}

// Value noise in [−1, 1] and its gradient; the twin is `expression/noise.rs`.
vec4 noise_of(const vec3 p) {
    vec3 cell = floor(clamp(p, -2147483000.0, 2147483000.0));
    precise vec3 t = p - cell;
    precise vec3 fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    vec3 slope = 30.0 * t * t * (t * (t - 2.0) + 1.0);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 8; ++k) {
        ivec3 o = ivec3(k, k >> 1, k >> 2) & 1;
        precise float value = float(noise_hash(ivec3(cell) + o) >> 8) * (2.0 / 16777216.0) - 1.0;
        vec3 w = mix(1.0 - fade, fade, bvec3(o));
        vec3 d = mix(-slope, slope, bvec3(o));
        precise vec4 term = value * vec4(w.x * w.y * w.z, d.x * w.y * w.z, w.x * d.y * w.z, w.x * w.y * d.z);
        sum += term;
    }
    return sum;
}
