// The prism over a triangle: P(b) + h N(b)/|N(b)| for heights h from `low` to `high`. With k = h/|N(b)| it is trilinear:
// P(b) + k N(b). Twin: reference/relief/shell.rs.

// How far beyond its sides a prism goes, as a weight, so that no ray slips between neighbours.
const float INFLATION = 1.0 / 4096.0;
// Beyond the least and the greatest height, of their distance.
const float HEIGHT_MARGIN = 1.0 / 64.0;
// Directions are told from each other by this least length of what lies between them, of the longest.
const float LEAST_LENGTH = 0.05;

// In units of the triangle's longest side, from its first corner.
struct Prism {
    vec3 first;      // mesh-local
    float side;      // longest, mesh-local; 0 where there is no prism
    mat3 corners;
    mat3 directions; // the longest is 1
    vec2 heights;    // with a margin, so that rays begin above what is as high as any and end below what is as low
    vec2 reach;      // least and greatest k of those heights
    vec3 upright;    // unit normal of the triangle
};

float longest_of(vec3 a, vec3 b, vec3 c) {
    return sqrt(max(max(dot(a, a), dot(b, b)), dot(c, c)));
}

// Of mesh-local corners, directions and heights.
Prism prism_of(mat3 corners, mat3 directions, vec2 heights) {
    Prism prism;
    prism.first = corners[0];
    vec3 along = corners[1] - corners[0];
    vec3 across = corners[2] - corners[0];
    float side = longest_of(along, across, across - along);
    float longest = longest_of(directions[0], directions[1], directions[2]);
    prism.side = 0.0;
    if (side <= 0.0 || side > 1e18 || longest <= 0.0 || longest > 1e18) {
        return prism;
    }
    prism.corners = mat3(vec3(0.0), along / side, across / side);
    prism.directions = mat3(directions[0] / longest, directions[1] / longest, directions[2] / longest);
    vec3 upright = cross(prism.corners[1], prism.corners[2]);
    float area = length(upright);
    vec3 middle = vec3(0.0);
    for (int i = 0; i < 3; ++i) {
        float size = length(directions[i]);
        middle += size > 0.0 ? directions[i] / size : vec3(0.0);
    }
    float spread = length(middle);
    if (area <= 1e-12 || spread <= 1e-6) {
        return prism;
    }
    prism.side = side;
    prism.upright = upright / area;
    float margin = max((heights.y - heights.x) / side * HEIGHT_MARGIN, INFLATION);
    prism.heights = heights / side + vec2(-margin, margin);
    vec3 lengths = middle / spread * prism.directions;
    float least = max(min(min(lengths.x, lengths.y), min(lengths.z, 1.0)), LEAST_LENGTH);
    prism.reach = vec2(
        prism.heights.x < 0.0 ? prism.heights.x / least : prism.heights.x,
        prism.heights.y > 0.0 ? prism.heights.y / least : prism.heights.y);
    return prism;
}

bool is_inside(vec3 weights) {
    return min(min(weights.x, weights.y), weights.z) >= -INFLATION;
}

// How the point moves with the second and the third weight, which the first makes up for, and with k.
mat3 prism_jacobian(Prism prism, vec3 weights, float k) {
    return mat3(
        prism.corners[1] - prism.corners[0] + (prism.directions[1] - prism.directions[0]) * k,
        prism.corners[2] - prism.corners[0] + (prism.directions[2] - prism.directions[0]) * k,
        prism.directions * weights);
}

// The solution of m x = v.
vec3 solved(mat3 m, vec3 v) {
    vec3 c = cross(m[1], m[2]);
    return vec3(dot(c, v), dot(cross(v, m[2]), m[0]), dot(cross(m[1], v), m[0])) / dot(c, m[0]);
}
