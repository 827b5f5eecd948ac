// Elementary functions in f32 that give the same bits on every device: no built-in sine, exponential or
// logarithm is exact enough or equal everywhere. Polynomials by Moshier (Cephes, single precision).

#define NOT_A_NUMBER uintBitsToFloat(0x7fc00000u)
#define INFINITY uintBitsToFloat(0x7f800000u)

// Sine (quadrant 0) and cosine (quadrant 1), good to about one unit of 1 for |x| up to 8192.
vec2 sine_cosine(float x) {
    precise float q = floor(x * 0.636619772 + 0.5);
    precise float r = ((x - q * 1.5703125) - q * 4.837512969970703125e-4) - q * 7.549789954891882e-8;
    precise float z = r * r;
    precise float s = r + r * z * (-1.6666654611e-1 + z * (8.3321608736e-3 - z * 1.9515295891e-4));
    precise float c = 1.0 - 0.5 * z + z * z * (4.166664568298827e-2 + z * (-1.388731625493765e-3 + z * 2.443315711809948e-5));
    uint quadrant = uint(int(clamp(q, -2147483000.0, 2147483000.0)));
    vec2 sc = (quadrant & 1u) == 0u ? vec2(s, c) : vec2(c, -s);
    return (quadrant & 2u) == 0u ? sc : -sc;
}

float exp2_of(float x) {
    x = clamp(x, -150.0, 129.0);
    precise float whole = floor(x + 0.5);
    precise float f = x - whole;
    precise float p = ((((1.535336188319500e-4 * f + 1.339887440266574e-3) * f + 9.618437357674640e-3) * f
        + 5.550332471162809e-2) * f + 2.402264791363012e-1) * f + 6.931472028550421e-1;
    int e = int(whole);
    int half_e = e / 2;
    // Two factors, so that neither leaves the normal range before the product does.
    precise float scaled = (1.0 + f * p) * uintBitsToFloat(uint(half_e + 127) << 23) * uintBitsToFloat(uint(e - half_e + 127) << 23);
    return scaled;
}

float log2_of(float x) {
    if (!(x > 0.0)) {
        return x == 0.0 ? -INFINITY : NOT_A_NUMBER;
    }
    uint bits = floatBitsToUint(x);
    // Mantissa in [√½, √2).
    int e = int(bits - 0x3f3504f3u) >> 23;
    precise float m = uintBitsToFloat(bits - (uint(e) << 23)) - 1.0;
    precise float z = m * m;
    precise float p = (((((((7.0376836292e-2 * m - 1.1514610310e-1) * m + 1.1676998740e-1) * m - 1.2420140846e-1) * m
        + 1.4249322787e-1) * m - 1.6668057665e-1) * m + 2.0000714765e-1) * m - 2.4999993993e-1) * m + 3.3333331174e-1;
    precise float y = m * z * p - 0.5 * z;
    precise float log2_m = ((y * 0.44269504088896340 + m * 0.44269504088896340) + y) + m;
    return float(e) + log2_m;
}

float arc_tangent(float x) {
    float a = abs(x);
    bool steep = a > 2.414213562373095;
    bool middle = a > 0.4142135623730950;
    precise float t = steep ? -1.0 / a : (middle ? (a - 1.0) / (a + 1.0) : a);
    float offset = steep ? 1.5707963267948966 : (middle ? 0.7853981633974483 : 0.0);
    precise float z = t * t;
    precise float y = offset + ((((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1) * z * t + t);
    return x < 0.0 ? -y : y;
}

float arc_tangent2(float y, float x) {
    const float PI = 3.14159265358979;
    if (x == 0.0) {
        return y == 0.0 ? 0.0 : sign(y) * (0.5 * PI);
    }
    float a = arc_tangent(y / x);
    return x > 0.0 ? a : (y < 0.0 ? a - PI : a + PI);
}

// x^n for |n| <= 31 by squaring.
float power_integer(float x, int n) {
    precise float result = 1.0;
    precise float square = x;
    uint left = uint(abs(n));
    for (int k = 0; k < 5; ++k) {
        result *= (left & 1u) == 1u ? square : 1.0;
        square *= square;
        left >>= 1u;
    }
    return n < 0 ? 1.0 / result : result;
}

uint noise_hash(ivec3 p) {
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
vec4 noise_of(vec3 p) {
    vec3 cell = floor(clamp(p, -2147483000.0, 2147483000.0));
    precise vec3 t = p - cell;
    precise vec3 fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    vec3 slope = 30.0 * t * t * (t * (t - 2.0) + 1.0);
    ivec3 c = ivec3(cell);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 8; ++k) {
        ivec3 o = ivec3(k & 1, k >> 1 & 1, k >> 2);
        precise float value = float(noise_hash(c + o) >> 8) * (2.0 / 16777216.0) - 1.0;
        vec3 w = mix(1.0 - fade, fade, bvec3(o));
        vec3 d = mix(-slope, slope, bvec3(o));
        precise vec4 term = value * vec4(w.x * w.y * w.z, d.x * w.y * w.z, w.x * d.y * w.z, w.x * w.y * d.z);
        sum += term;
    }
    return sum;
}
