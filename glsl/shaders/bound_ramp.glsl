// The ramp along one side of a base triangle, over a triangle within it. Include after bound.glsl and bound_field.glsl.

// Corners are in the order first along the side, last, in between.
struct Ramp {
    vec3 weight;
    float kink; // how far the weight is from what is linear
    vec3 to;
    vec3 from;
    uvec3 along; // units
};

// Component k of three vectors.
uvec3 row(const uvec3 a, const uvec3 b, const uvec3 c, const uint k) {
    return uvec3(a[k], b[k], c[k]);
}

void order(inout Ramp ramp) {
    if (ramp.along.x > ramp.along.y) {
        ramp.along = ramp.along.yxz;
        ramp.weight = ramp.weight.yxz;
    }
    if (ramp.along.z < ramp.along.x) {
        ramp.along = ramp.along.zyx;
        ramp.weight = ramp.weight.zyx;
    }
    if (ramp.along.z > ramp.along.y) {
        ramp.along = ramp.along.xzy;
        ramp.weight = ramp.weight.xzy;
    }
}

// Corners are given in units.
Ramp ramp_of(const uint side, const float inverse_width, const uint reversed, const uvec3 a, const uvec3 b, const uvec3 c) {
    uint next = side == 2u ? 0u : side + 1u;
    bool runs_back = (reversed >> side & 1u) == 1u;
    Ramp ramp;
    vec3 weight = 1.0 - vec3(row(a, b, c, 3u - side - next)) * (SHARE * inverse_width);
    float low = min(weight.x, min(weight.y, weight.z)), high = largest(weight);
    ramp.kink = low < 0.0 && high > 0.0 ? -low * high / (high - low) : 0.0;
    ramp.weight = max(weight, 0.0);
    ramp.to = vec3(row(a, b, c, runs_back ? side : next)) * SHARE;
    ramp.from = vec3(row(a, b, c, runs_back ? next : side)) * SHARE;
    // The corner opposite is nowhere along the side, and its weight is 0.
    vec3 both = ramp.to + ramp.from;
    vec3 along = mix(vec3(2.0), ramp.to / max(both, SHARE), greaterThan(both, vec3(0.0)));
    float first = min(along.x, min(along.y, along.z));
    ramp.along = uvec3(mix(along, vec3(first), greaterThan(along, vec3(1.0))) / SHARE + 0.5);
    order(ramp);
    return ramp;
}

// What the ramp adds, where the triangle's side is short of `short_of` at the three places, and by how much that bends in
// between.
float ramp_bound(const Ramp ramp, const mat3 short_of, const float bend) {
    float range = float(ramp.along.y - ramp.along.x) * SHARE;
    float curvature = bend;
    if (range > 0.0) {
        float slope = distance(short_of[0], short_of[1]) / range;
        curvature = 2.0 * bend + slope * ratio_curvature(ramp.to, ramp.from, range);
    }
    return product_curvature(Field(short_of, curvature), ramp.weight, ramp.kink);
}
