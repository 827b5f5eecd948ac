// Sine, cosine and angle in f32 that give the same bits on every device: built-in ones are neither exact enough nor
// equal everywhere. Polynomials by Moshier (Cephes, single precision) and Abramowitz & Stegun 4.4.49.

// Sine and cosine, good to about one unit of 1 for |x| up to 8192.
vec2 sine_cosine(const float x) {
    precise float q = floor(x * 0.636619772 + 0.5);
    precise float r = ((x - q * 1.5703125) - q * 4.837512969970703125e-4) - q * 7.549789954891882e-8;
    precise float z = r * r;
    precise float s = r + r * z * (-1.6666654611e-1 + z * (8.3321608736e-3 - z * 1.9515295891e-4));
    precise float c = 1.0 - 0.5 * z + z * z * (4.166664568298827e-2 + z * (-1.388731625493765e-3 + z * 2.443315711809948e-5));
    int quadrant = int(clamp(q, -2147483000.0, 2147483000.0));
    vec2 sc = (quadrant & 1) == 0 ? vec2(s, c) : vec2(c, -s);
    return (quadrant & 2) == 0 ? sc : -sc;
}

float arc_tangent2(const float y, const float x) {
    float low = min(abs(x), abs(y));
    float high = max(abs(x), abs(y));
    precise float t = high == 0.0 ? 0.0 : low / high;
    precise float z = t * t;
    precise float octant = t * (0.9999993329 + z * (-0.3332985605 + z * (0.1994653599 + z * (-0.1390853351
        + z * (0.0964200441 + z * (-0.0559098861 + z * (0.0218612288 - z * 0.0040540580)))))));
    precise float quadrant = abs(y) > abs(x) ? 1.5707963267948966 - octant : octant;
    precise float half_turn = x < 0.0 ? 3.1415926535897932 - quadrant : quadrant;
    return y < 0.0 ? -half_turn : half_turn;
}
