// The ellipse that a pixel covers on a map (Heckbert 1989).

// Longest side of a footprint in its shortest, beyond which the shortest is widened.
const float MAX_ANISOTROPY = 16.0;

// J takes a pixel to texels of the finest level; the image of the unit circle is an ellipse with half axes of `major` and
// `minor` texels, the singular values of J.
struct Footprint {
    vec3 spread;  // xx, xy and yy of J J^T, its shorter axis widened to `minor`
    float major;  // not finite where a derivative is not a number or too large to be squared
    float minor;  // at least major / MAX_ANISOTROPY
    vec2 along;   // unit, along the major axis in texels; any direction where there is no longer axis
};

// By the bits: comparisons may be compiled as if every number were one.
bool finite(float x) {
    return (floatBitsToUint(x) & 0x7F800000u) != 0x7F800000u;
}

// The eigenvector of the larger eigenvalue, from the row of the matrix that does not cancel.
vec2 along_major(float halved, float xy, float root) {
    vec2 v = halved >= 0.0 ? vec2(halved + root, xy) : vec2(xy, root - halved);
    float largest = max(abs(v.x), abs(v.y));
    return largest > 0.0 ? normalize(v / largest) : vec2(1.0, 0.0);
}

Footprint footprint_of(vec2 size, vec2 dx, vec2 dy) {
    vec2 a = dx * size;
    vec2 b = dy * size;
    vec3 spread = vec3(a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
    float halved = 0.5 * (spread.x - spread.z);
    float root = length(vec2(halved, spread.y));
    float major = sqrt(0.5 * (spread.x + spread.z) + root);
    // The determinant is the product of the axes; the difference of mean and root would cancel.
    float narrow = major > 0.0 ? abs(a.x * b.y - a.y * b.x) / major : 0.0;
    float minor = max(narrow, major / MAX_ANISOTROPY);
    float wider = minor * minor - narrow * narrow;
    return Footprint(spread + vec3(wider, 0.0, wider), major, minor, along_major(halved, spread.y, root));
}
