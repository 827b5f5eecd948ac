// Quantities that vary over a triangle, known at its corners and up to a bound in between: how far they are at most from
// what is interpolated between the corners. The twin is `reference/bound/field.rs`.

// Sum of l (1 - l)^2 / 2 over the shares l is at most this: the remainder of interpolation, over the largest second
// derivative between corners.
const float REMAINDER = 2.0 / 9.0;

// Vectors over a triangle: the corners are columns.
struct Field {
    mat3 corners;
    float curvature;
};

float largest(const vec3 v) {
    return max(v.x, max(v.y, v.z));
}

// How much any two corners differ.
vec3 steps(const mat3 m) {
    return vec3(distance(m[0], m[1]), distance(m[1], m[2]), distance(m[2], m[0]));
}

vec3 steps(const vec3 s) {
    return abs(s - s.yzx);
}

float longest(const mat3 m) {
    return largest(vec3(length(m[0]), length(m[1]), length(m[2])));
}

// For interpolated A and B with these steps, A B is so far from what is interpolated between its corners.
float cross_term(const vec3 a, const vec3 b) {
    vec3 products = a * b;
    return min(0.25 * (products.x + products.y + products.z), largest(products) / 3.0);
}

// The curvature of a field times a number with these corners and this curvature.
float product_curvature(const Field field, const vec3 corners, const float curvature) {
    float a = longest(field.corners) + field.curvature;
    float b = largest(abs(corners)) + curvature;
    float sum = field.curvature * b + a * curvature + cross_term(steps(field.corners), steps(corners));
    return min(sum, 2.0 * a * b);
}

// The curvature of v / max(|by|, least), both interpolated.
float quotient_curvature(const mat3 v, const mat3 by, const float least) {
    vec3 middle = (by[0] + by[1] + by[2]) / 3.0;
    float spread = longest(mat3(by[0] - middle, by[1] - middle, by[2] - middle));
    float low = max(length(middle) - spread, least);
    float most = longest(v);
    float own = largest(steps(v));
    float step = largest(steps(by));
    float curvature = 0.0;
    if (step > 0.0 && longest(by) > least) {
        curvature = REMAINDER * (2.0 * own * step + 2.0 * most * step * step / low) / (low * low);
        // Where the least length takes over there is a kink.
        curvature += low <= least ? 2.0 / 3.0 * most * step / (least * least) : 0.0;
    }
    return min(curvature, 2.0 * most / low);
}

// How far to / (to + from) is at most from what is interpolated, where both are linear: no more than its range.
float ratio_curvature(const vec3 to, const vec3 from, const float range) {
    vec3 both = to + from;
    float low = min(both.x, min(both.y, both.z));
    float slopes = largest(steps(both)) * max(largest(steps(to)), largest(steps(from)));
    return low > 0.0 ? min(2.0 * REMAINDER * slopes / (low * low), range) : range;
}
