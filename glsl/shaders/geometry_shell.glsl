// What of a ray lies in the prism over a triangle (Porumbescu, Budge, Feng and Joy 2005). Its sides are ruled, so that a ray
// meets each where a quadratic is zero (Ramsey, Potter and Hansen 2004), and the place under a point follows by Newton's
// method. Twins: reference/relief/shell.rs, reference/relief/shell/range.rs.
#include "geometry_prism.glsl"

// Newton's method has found the place after these, or there is none.
const uint NEWTON_STEPS = 8u;
// Of a prism's size: how near a place must come to the point it is under.
const float NEWTON_RESIDUAL = 1e-4;

// A place under a point, or over it where the height is negative.
struct Under {
    vec3 weights; // of the corners; their sum is 1
    float k;      // along the directions as they are between the corners
    bool found;
};

// Weights of a corner of the inflated triangle.
vec3 inflated_corner(int corner) {
    vec3 weights = vec3(-INFLATION);
    weights[corner] = 1.0 + 2.0 * INFLATION;
    return weights;
}

// Mesh-local height of a place.
float height_of_place(Prism prism, Under under) {
    return under.k * length(prism.directions * under.weights) * prism.side;
}

// The place under a point in units of the prism, by Newton's method from `near`.
Under place_under(Prism prism, vec3 point, Under near) {
    Under at = near;
    vec3 rest = point - prism.corners * at.weights - prism.directions * at.weights * at.k;
    [[dont_unroll]] for (uint n = 0u; n < NEWTON_STEPS; ++n) {
        vec3 change = solved(prism_jacobian(prism, at.weights, at.k), rest);
        at.weights += vec3(-change.x - change.y, change.x, change.y);
        at.k += change.z;
        rest = point - prism.corners * at.weights - prism.directions * at.weights * at.k;
    }
    at.found = max(max(abs(rest.x), abs(rest.y)), abs(rest.z)) <= NEWTON_RESIDUAL;
    return at;
}

// Where Newton's method starts for a point that nothing is known of: under the middle.
Under guess_under(Prism prism, vec3 point) {
    vec3 weights = vec3(1.0 / 3.0);
    float rise = dot(prism.directions * weights, prism.upright);
    float k = rise > LEAST_LENGTH ? dot(point, prism.upright) / rise : 0.0;
    return Under(weights, clamp(k, prism.reach.x, prism.reach.y), false);
}

bool holds_place(Prism prism, vec3 point) {
    Under under = place_under(prism, point, guess_under(prism, point));
    float slack = prism.reach.y - prism.reach.x;
    bool is_near = under.k >= prism.reach.x - slack && under.k <= prism.reach.y + slack;
    return under.found && is_near && is_inside(under.weights);
}

const vec2 NO_RANGE = vec2(1.0, 0.0);

// What of a ray is in a sphere around the prism, and between two planes along the triangle.
vec2 range_around(Prism prism, vec3 origin, vec3 direction) {
    vec3 hull[6];
    vec3 middle = vec3(0.0);
    for (int i = 0; i < 3; ++i) {
        vec3 weights = inflated_corner(i);
        vec3 corner = prism.corners * weights;
        vec3 along = prism.directions * weights;
        hull[i] = corner + along * prism.reach.x;
        hull[i + 3] = corner + along * prism.reach.y;
        middle += (hull[i] + hull[i + 3]) / 6.0;
    }
    float radius_squared = 0.0;
    vec2 levels = vec2(3e38, -3e38);
    for (int i = 0; i < 6; ++i) {
        vec3 out_to = hull[i] - middle;
        radius_squared = max(radius_squared, dot(out_to, out_to));
        float level = dot(hull[i], prism.upright);
        levels = vec2(min(levels.x, level), max(levels.y, level));
    }
    float squared = dot(direction, direction);
    float nearest = dot(middle - origin, direction) / squared;
    vec3 off = origin + direction * nearest - middle;
    float span = sqrt(max(radius_squared - dot(off, off), 0.0) / squared);
    vec2 range = vec2(nearest - span, nearest + span);
    float from = dot(origin, prism.upright);
    float rate = dot(direction, prism.upright);
    if (rate == 0.0) {
        return from < levels.x || from > levels.y ? NO_RANGE : range;
    }
    vec2 along = (levels - from) / rate;
    return vec2(max(range.x, min(along.x, along.y)), min(range.y, max(along.x, along.y)));
}

const uint PRISM_CUTS = 8u;

// Where a ray meets the surface that an inflated side lies in; no number where it does not.
vec2 side_cuts(Prism prism, int side, vec3 origin, vec3 direction) {
    vec3 from = inflated_corner(side);
    vec3 change = inflated_corner((side + 1) % 3) - from;
    vec3 a = prism.corners * from - origin;
    vec3 da = prism.corners * change;
    vec3 m = prism.directions * from;
    vec3 dm = prism.directions * change;
    vec3 across = cross(m, direction);
    vec3 turn = cross(dm, direction);
    float c0 = dot(a, across);
    float c1 = dot(da, across) + dot(a, turn);
    float c2 = dot(da, turn);
    float discriminant = c1 * c1 - 4.0 * c0 * c2;
    if (discriminant < 0.0) {
        return vec2(-3e38);
    }
    float q = -0.5 * (c1 + (c1 < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
    vec2 cuts = vec2(-3e38);
    for (int root = 0; root < 2; ++root) {
        // Tested before they divide: comparisons may be compiled as if every number were one.
        float over = root == 0 ? c2 : q;
        float s = over != 0.0 ? (root == 0 ? q : c0) / over : 2.0;
        vec3 n = m + dm * s;
        vec3 normal = cross(direction, n);
        float squared = dot(normal, normal);
        if (s > -0.125 && s < 1.125 && squared > 0.0) {
            cuts[root] = dot(cross(a + da * s, n), normal) / squared;
        }
    }
    return cuts;
}

// From where to where a ray, in units of the prism, is between its sides; what lies between, if it goes out and comes back
// in, counts as inside. It may begin above the greatest height or end below the least.
vec2 prism_range(Prism prism, vec3 origin, vec3 direction) {
    vec2 around = range_around(prism, origin, direction);
    if (around.x >= around.y) {
        return NO_RANGE;
    }
    float cuts[PRISM_CUTS];
    cuts[0] = around.x;
    uint count = 1u;
    for (int side = 0; side < 3; ++side) {
        vec2 met = side_cuts(prism, side, origin, direction);
        for (int root = 0; root < 2; ++root) {
            float t = met[root];
            if (t > around.x && t < around.y) {
                uint place = count++;
                for (; place > 1u && cuts[place - 1u] > t; --place) {
                    cuts[place] = cuts[place - 1u];
                }
                cuts[place] = t;
            }
        }
    }
    cuts[count] = around.y;
    vec2 range = NO_RANGE;
    [[dont_unroll]] for (uint n = 0u; n < count; ++n) {
        if (holds_place(prism, origin + direction * (0.5 * (cuts[n] + cuts[n + 1u])))) {
            range = vec2(range.x > range.y ? cuts[n] : range.x, cuts[n + 1u]);
        }
    }
    return range;
}
