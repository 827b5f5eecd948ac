// Jets, and the frame of the base surface at a site: position, shading normal, displacement direction,
// texture coordinates and tangents, each with its derivatives. The twin is `reference/frame.rs`.
// Include after tables.glsl.

// A vector jet is a mat3 (value, derivative along b1, derivative along b2); a scalar jet is a vec3.

// Shortest blended normal a direction is divided by: opposite normals would send it to infinity.
const float MIN_BLENDED_NORMAL = 0.125;
// Squared length below which a tangent is as good as parallel to the normal.
const float MIN_TANGENT_SQUARE = 1e-8;

mat3 jet(const vec3 b, const vec3 x, const vec3 y, const vec3 z) {
    return mat3(blend(b, x, y, z), y - x, z - x);
}

vec3 jet(const vec3 b, const float x, const float y, const float z) {
    precise float value = b.x * x + b.y * y + b.z * z;
    return vec3(value, y - x, z - x);
}

mat3 product(const vec3 s, const mat3 m) {
    return mat3(s.x * m[0], s.y * m[0] + s.x * m[1], s.z * m[0] + s.x * m[2]);
}

vec3 dot_jet(const mat3 a, const mat3 b) {
    return vec3(dot(a[0], b[0]), dot(a[1], b[0]) + dot(a[0], b[1]), dot(a[2], b[0]) + dot(a[0], b[2]));
}

mat3 cross_jet(const mat3 a, const mat3 b) {
    return mat3(cross(a[0], b[0]), cross(a[1], b[0]) + cross(a[0], b[1]), cross(a[2], b[0]) + cross(a[0], b[2]));
}

// 1 / |m|, with its derivatives; flat where `least` takes over.
vec3 inverse_length(const mat3 m, const float least) {
    float size = length(m[0]);
    float r = 1.0 / max(size, least);
    float slope = size > least ? -r * r * r : 0.0;
    return vec3(r, slope * dot(m[0], m[1]), slope * dot(m[0], m[2]));
}

// Unit vector at right angles to unit n.
vec3 any_perpendicular(const vec3 n) {
    vec3 axis = abs(n.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    vec3 q = axis - n * dot(n, axis);
    return q / length(q);
}

struct Frame {
    mat3 position;
    mat3 normal;
    mat3 direction;
    vec3 u;
    vec3 v;
};

Frame frame_at(const Site site) {
    vec4 p0 = position_u(site.av.x), p1 = position_u(site.av.y), p2 = position_u(site.av.z);
    vec4 d0 = direction_v(site.av.x), d1 = direction_v(site.av.y), d2 = direction_v(site.av.z);
    mat3 normal = jet(site.b, normal_of(site.av.x), normal_of(site.av.y), normal_of(site.av.z));
    return Frame(
        jet(site.b, p0.xyz, p1.xyz, p2.xyz),
        product(inverse_length(normal, 1e-12), normal),
        product(inverse_length(normal, MIN_BLENDED_NORMAL), jet(site.b, d0.xyz, d1.xyz, d2.xyz)),
        jet(site.b, p0.w, p1.w, p2.w),
        jet(site.b, d0.w, d1.w, d2.w)
    );
}
