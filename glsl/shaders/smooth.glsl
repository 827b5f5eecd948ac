// The base surface at a site, with derivatives, where the base is smooth: Bézier triangles, split around places where
// one would not do. The twin is `reference/smooth.rs`. Include after frame.glsl.

// A part of a base triangle: either split into four (corners 0, 1, 2, middle), or one patch. Node t is base triangle t.
struct PatchNode {
    uint parts;  // first of four, or NO_PART
    uint points; // origin, then the net less the origin
    uint degree; // 2 to 4
    uint normals; // two quadratic nets, of normals and directions; or NO_PART: the patch's own normals
    uint given;   // of a whole triangle: mask of its corners and their directions, or NO_PART
    float side;   // of the winding on which the normals are
};

PAGED(13, readonly, PatchNode, patch_nodes);
PAGED(14, readonly, vec3, patch_points);

const uint NO_PART = 0xffffffffu;
// Site.patch of a place at an attribute vertex.
const uint AT_VERTEX = 0xffffffffu;
const uint MOST_SPLITS = 24u;

// Of a polynomial: value, derivatives along b1 and b2, second derivatives along 11, 12, 22.
struct SecondJet {
    mat3 value;
    mat3 second;
};

#include "fields.glsl"

// The net of `degree` (2 to 4) from `first` on, at b: de Casteljau's algorithm down to degree 2, then by hand.
SecondJet second_jet(const uint first, const uint degree, const vec3 b) {
    vec3 q[15];
    uint points = (degree + 1u) * (degree + 2u) / 2u;
    for (uint i = 0u; i < 15u; ++i) {
        q[i] = i < points ? LOAD(patch_points, first + i) : vec3(0.0);
    }
    for (uint d = 4u; d > 2u; --d) {
        uint from = 0u;
        uint to = 0u;
        for (uint k = 0u; d <= degree && k < d; ++k) {
            for (uint j = 0u; j + k < d; ++j) {
                precise vec3 blended = b.x * q[from] + b.y * q[from + 1u] + b.z * q[from + d + 1u - k];
                q[to] = blended;
                ++from;
                ++to;
            }
            ++from;
        }
    }
    precise vec3 l0 = b.x * q[0] + b.y * q[1] + b.z * q[3];
    precise vec3 l1 = b.x * q[1] + b.y * q[2] + b.z * q[4];
    precise vec3 l2 = b.x * q[3] + b.y * q[4] + b.z * q[5];
    precise vec3 value = b.x * l0 + b.y * l1 + b.z * l2;
    float d = float(degree);
    mat3 second = mat3(q[2] - 2.0 * q[1] + q[0], q[4] - q[1] - q[3] + q[0], q[5] - 2.0 * q[3] + q[0]);
    return SecondJet(mat3(value, d * (l1 - l0), d * (l2 - l0)), d * (d - 1.0) * second);
}

mat3 scaled(const mat3 jet, const float scale) {
    return mat3(jet[0], scale * jet[1], scale * jet[2]);
}

// Unit. Lengths of the derivatives do not matter: their scale goes before their product is made.
mat3 own_normal(const SecondJet p, const float side) {
    float size = max(length(p.value[1]), length(p.value[2]));
    float by = size > 0.0 ? 1.0 / size : 0.0;
    vec3 u = p.value[1] * by;
    vec3 v = p.value[2] * by;
    mat3 second = p.second * by;
    mat3 normal = side * mat3(
        cross(u, v), cross(second[0], v) + cross(u, second[1]), cross(second[1], v) + cross(u, second[2])
    );
    return product(inverse_length(normal, 1e-12), normal);
}

// Directions that corners are given take the place of what is there, by the corners' weights.
mat3 with_given(const mat3 direction, const vec3 b, const uint first) {
    vec3 mask = LOAD(patch_points, first);
    vec3 left = vec3(1.0 - dot(b, mask), mask.x - mask.y, mask.x - mask.z);
    vec3 d0 = mask.x * LOAD(patch_points, first + 1u);
    vec3 d1 = mask.y * LOAD(patch_points, first + 2u);
    vec3 d2 = mask.z * LOAD(patch_points, first + 3u);
    return product(left, direction) + jet(b, d0, d1, d2);
}

// Both derivatives become that from one end of an edge to the other; within a triangle they stay.
mat3 along_edge(const mat3 jet, const uint code) {
    if (code == 0u) {
        return jet;
    }
    uint first = (code - 1u) / 2u;
    uint second = (first + 1u) % 3u;
    vec3 from = first == 0u ? vec3(0.0) : jet[first];
    vec3 to = second == 0u ? vec3(0.0) : jet[second];
    vec3 slope = (code - 1u) % 2u == 1u ? from - to : to - from;
    return mat3(jet[0], slope, slope);
}

// Barycentrics of the base triangle from those of the site.
vec3 within_triangle(const Site site) {
    uint code = site.patch_code % 8u;
    if (code == 0u) {
        return site.b;
    }
    uint first = (code - 1u) / 2u;
    uint second = (first + 1u) % 3u;
    bool reversed = (code - 1u) % 2u == 1u;
    vec3 b = vec3(0.0);
    b[reversed ? second : first] = site.b.x;
    b[reversed ? first : second] = site.b.y + site.b.z;
    return b;
}

// The patch that has the place b of triangle t; b becomes its place there. Derivatives along the patch count `scale`
// along the triangle.
PatchNode leaf_at(const uint t, inout vec3 b, out float scale) {
    PatchNode node = LOAD(patch_nodes, t);
    scale = 1.0;
    for (uint i = 0u; i < MOST_SPLITS && node.parts != NO_PART; ++i) {
        uint part = b.x >= 0.5 ? 0u : (b.y >= 0.5 ? 1u : (b.z >= 0.5 ? 2u : 3u));
        b = part == 3u ? vec3(1.0) - 2.0 * b : 2.0 * b - vec3(part == 0u, part == 1u, part == 2u);
        scale *= part == 3u ? -2.0 : 2.0;
        node = LOAD(patch_nodes, node.parts + part);
    }
    return node;
}

Fields vertex_fields(const uint av) {
    Fields fields = Fields(mat3(0.0), mat3(0.0), mat3(0.0));
    fields.position[0] = position_u(av).xyz;
    fields.normal[0] = normal_of(av);
    fields.direction[0] = direction_v(av).xyz;
    return fields;
}

Fields fields_at(const Site site) {
    if (site.patch_code == AT_VERTEX) {
        return vertex_fields(site.av.x);
    }
    uint t = site.patch_code / 8u;
    uint code = site.patch_code % 8u;
    vec3 whole = within_triangle(site);
    vec3 b = whole;
    float scale;
    PatchNode leaf = leaf_at(t, b, scale);
    SecondJet p = second_jet(leaf.points + 1u, leaf.degree, b);
    mat3 normal;
    mat3 direction;
    if (leaf.normals == NO_PART) {
        normal = scaled(own_normal(p, leaf.side), scale);
        direction = normal;
    } else {
        mat3 blended = scaled(second_jet(leaf.normals, 2u, b).value, scale);
        normal = product(inverse_length(blended, 1e-12), blended);
        direction = scaled(second_jet(leaf.normals + 6u, 2u, b).value, scale);
        direction = product(inverse_length(blended, MIN_BLENDED_NORMAL), direction);
    }
    uint given_at = LOAD(patch_nodes, t).given;
    if (given_at != NO_PART) {
        direction = with_given(direction, whole, given_at);
    }
    mat3 position = scaled(p.value, scale);
    precise vec3 place = LOAD(patch_points, leaf.points) + position[0];
    position[0] = place;
    return Fields(along_edge(position, code), along_edge(normal, code), along_edge(direction, code));
}
