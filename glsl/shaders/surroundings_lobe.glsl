// What every pass that finds what fragments see of an environment has: bindings, and means over the lobe of a surface by
// filtered importance sampling (Krivanek and Colbert 2008).
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "raster_tables.glsl"
#include "appearance.glsl"
#include "texel_pair.glsl"
#include "trigonometry.glsl"
#include "brdf.glsl"
#include "surroundings.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform SurroundingsParams {
    uint count;
    uint normals; // NORMALS_*
    uint mips;    // levels of the environment's map; irradiance follows
    uint samples; // of a lobe; 0: every surface is a mirror
    vec4 eye;     // w = 1: a place; w = 0: the direction towards an orthographic camera
    uint of_material; // 1 + the material that sees this environment; 0: all do
    uint has_room;    // whether what is seen are the walls of a box, from a place in it
    vec3 centre;      // world
    vec3 low;
    vec3 high;
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Appearance, appearances);
PAGED(2, readonly, vec3, positions);
PAGED(3, readonly, vec3, normals);
PAGED(4, readonly, vec4, instance_rows);
PAGED(5, readonly, uvec4, environment_levels);
PAGED(6, readonly, TexelPair, environment_texels);
PAGED(7, writeonly, Surroundings, surroundings);
#include "world.glsl"
#include "footprint.glsl"
#include "environment.glsl"

// Seen from the front, next to nothing is reflected as at grazing angles: it is lit as the rest is.
const float LEAST_WEIGHT = 1e-6;
const float GOLDEN_TURN = 2.39996322973;

// Half vectors of GGX around z as `v` sees them (Heitz 2018), by caps of the ball that the ellipsoid comes from (Dupuy and
// Benyoub 2023).
vec3 half_vector(vec3 v, float alpha, vec2 u) {
    vec3 stretched = normalize(vec3(v.xy * alpha, v.z));
    float z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    float radius = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    vec3 cap = vec3(radius * cos(u.x), radius * sin(u.x), z) + stretched;
    return normalize(vec3(cap.xy * alpha, max(cap.z, 1e-6)));
}

// What a sample stands for: light, what is reflected of it, and the radians that it fills.
struct LobeSample {
    vec3 light;
    float weight;
    float fresnel;
    float width;
};

LobeSample lobe_sample(vec3 v, float alpha, uint i) {
    float n = float(params.samples);
    vec3 h = half_vector(v, alpha, vec2(GOLDEN_TURN * float(i), (float(i) + 0.5) / n));
    float vh = dot(v, h);
    vec3 l = 2.0 * vh * h - v;
    float towards = 2.0 * v.z / (v.z + masking(alpha * alpha, v.z));
    float density = towards * distribution(alpha, h.z, dot(h.xy, h.xy)) / (4.0 * v.z);
    float weight = l.z > 0.0 ? visibility(alpha, v.z, l.z) * 4.0 * l.z * v.z / towards : 0.0;
    return LobeSample(l, weight, grazing(vh), inversesqrt(n * density));
}

// A frame of the world with z along `n` and v in its xz plane.
mat3 lobe_frame(vec3 v, vec3 n, float cosine) {
    vec3 side = v - cosine * n;
    float across = dot(side, side);
    vec3 other = abs(n.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    vec3 x = across > 1e-8 ? side * inversesqrt(across) : normalize(cross(n, other));
    return mat3(x, cross(n, x), n);
}

vec3 in_lobe_frame(float cosine) {
    return vec3(sqrt(max(1.0 - cosine * cosine, 0.0)), 0.0, cosine);
}

vec3 irradiance_at(vec3 n) {
    return environment_at(LOAD(environment_levels, params.mips), place_of(n));
}

bool is_seen_by(uint material) {
    return params.of_material == 0u || params.of_material == material + 1u;
}

// What arrives from `d`: in a room, from where the wall is met, as its centre sees that (box projection, Lagarde and
// Zanuttini 2012).
vec3 arriving(vec3 position, vec3 d, float width) {
    if (params.has_room == 0u) {
        return environment_mirror(d, width, params.mips);
    }
    vec3 inverse = mix(vec3(1.0), vec3(-1.0), lessThan(d, vec3(0.0))) / max(abs(d), vec3(1e-20));
    vec3 far = max((params.low - position) * inverse, (params.high - position) * inverse);
    float t = max(min(min(far.x, far.y), far.z), 0.0);
    vec3 wall = position + t * d - params.centre;
    return environment_mirror(wall, width * t * inversesqrt(max(dot(wall, wall), 1e-20)), params.mips);
}

// Sums over a lobe, and of their weights.
struct LobeSums {
    vec4 facing;
    vec4 grazing;
};

// Adds a sample, no finer than the pixel's footprint.
void add_sample(inout LobeSums sums, vec3 position, LobeSample s, mat3 world_from_local, float footprint) {
    if (s.weight > 0.0) {
        float width = max(s.width, footprint);
        vec4 light = vec4(arriving(position, world_from_local * s.light, width), 1.0);
        sums.facing += s.weight * (1.0 - s.fresnel) * light;
        sums.grazing += s.weight * s.fresnel * light;
    }
}

Surroundings of_sums(LobeSums sums, vec3 diffuse) {
    vec3 mean = sums.facing.rgb / max(sums.facing.a, 1e-20);
    return Surroundings(diffuse, mean, (sums.grazing.rgb + LEAST_WEIGHT * mean) / (sums.grazing.a + LEAST_WEIGHT));
}
