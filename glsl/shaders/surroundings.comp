#version 460
#extension GL_GOOGLE_include_directive : require
// What each fragment sees of an environment: by its whole hemisphere, and by the lobe of its roughness, or by a mirror. At
// the pixel's normal, or the triangle's where shading is flat. A thread per fragment.
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

layout(push_constant, scalar) uniform Params {
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

const uint NORMALS_OF_TRIANGLES = 2u;

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

// Means over the lobe by filtered importance sampling (Krivanek and Colbert 2008), no finer than the pixel's footprint.
Surroundings over_lobe(vec3 position, vec3 v, vec3 n, float roughness, float footprint) {
    float cosine = max(dot(n, v), MIN_COSINE);
    vec3 side = v - cosine * n;
    float across = dot(side, side);
    vec3 x = across > 1e-8 ? side * inversesqrt(across) : normalize(cross(n, abs(n.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0)));
    mat3 world_from_local = mat3(x, cross(n, x), n);
    vec3 local = vec3(sqrt(max(1.0 - cosine * cosine, 0.0)), 0.0, cosine);
    float alpha = max(roughness * roughness, MIN_ALPHA);
    vec4 facing = vec4(0.0);
    vec4 grazed = vec4(0.0);
    [[dont_unroll]] for (uint i = 0u; i < params.samples; ++i) {
        LobeSample s = lobe_sample(local, alpha, i);
        if (s.weight > 0.0) {
            float width = max(s.width, footprint);
            vec4 light = vec4(arriving(position, world_from_local * s.light, width), 1.0);
            facing += s.weight * (1.0 - s.fresnel) * light;
            grazed += s.weight * s.fresnel * light;
        }
    }
    // Seen from the front, next to nothing is reflected as at grazing angles: it is lit as the rest is.
    vec3 mean = facing.rgb / max(facing.a, 1e-20);
    return Surroundings(vec3(0.0), mean, (grazed.rgb + LEAST_WEIGHT * mean) / (grazed.a + LEAST_WEIGHT));
}

Surroundings seen(vec3 position, vec3 v, vec3 normal, float roughness, float footprint) {
    vec3 n = visible_normal(normal, v);
    Surroundings sky;
    if (params.samples == 0u) {
        vec3 mirrored = arriving(position, 2.0 * dot(n, v) * n - v, footprint);
        sky = Surroundings(vec3(0.0), mirrored, mirrored);
    } else {
        sky = over_lobe(position, v, n, clamp(roughness, 0.0, 1.0), footprint);
    }
    sky.diffuse = environment_at(LOAD(environment_levels, params.mips), place_of(n));
    return sky;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    if (params.of_material != 0u && params.of_material != point.material + 1u) {
        return;
    }
    bool flat_shaded = params.normals == NORMALS_OF_TRIANGLES;
    vec3 normal = flat_shaded ? point.facing : LOAD(appearances, i).normal;
    View view = view_of(params.eye, point.position);
    float footprint = mirrored_footprint(point, visible_normal(normal, view.towards), view, flat_shaded);
    STORE(surroundings, i, seen(point.position, view.towards, normal, LOAD(appearances, i).roughness, footprint));
}

#include "batch.glsl"
