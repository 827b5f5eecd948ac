#version 460
#extension GL_GOOGLE_include_directive : require
// Which share of each light reaches each fragment, by the depths that the light sees: of a window of five by five samples,
// those that are no nearer to the light than the plane of the fragment's triangle (percentage closer: Reeves, Salesin and
// Cook 1987; the receiver's plane: Isidoro 2006). A thread per fragment and light.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "appearance.glsl"
#include "lights.glsl"
#include "coverage.glsl"
#include "shadow_map.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // fragments x lights
    uint lights;
    uint any_normal; // whether light counts that the pixel's own normal faces away from
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Appearance, appearances);
PAGED(2, readonly, Light, lights);
PAGED(3, readonly, ShadowFace, faces); // SHADOW_FACES for each light
PAGED(4, readonly, vec4, depths);
PAGED(5, writeonly, float, shadows); // 1: the light is seen

// Vertices are moved to a grid of so many steps a texel.
const float SNAP_STEPS = 256.0;

// A place, or a change of one, as a side of the map has it: texels, and reversed depth.
struct Projected {
    vec3 at;
    float w;
};

Projected projected(ShadowFace face, vec4 place) {
    vec4 h = vec4(dot(face.row_x, place), dot(face.row_y, place), dot(face.row_z, place), dot(face.row_w, place));
    return Projected(h.xyz / h.w, h.w);
}

// How it changes along a direction of the world.
vec3 change(ShadowFace face, Projected p, vec3 along) {
    vec4 h = vec4(dot(face.row_x.xyz, along), dot(face.row_y.xyz, along), dot(face.row_z.xyz, along), dot(face.row_w.xyz, along));
    return (h.xyz - p.at * h.w) / p.w;
}

// Change of depth per texel over the plane across `facing`.
vec2 depth_slope(ShadowFace face, Projected p, vec3 facing) {
    vec3 side = normalize(cross(facing, abs(facing.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0)));
    vec3 a = change(face, p, side);
    vec3 b = change(face, p, cross(facing, side));
    float area = a.x * b.y - a.y * b.x;
    vec2 slope = vec2(a.z * b.y - b.z * a.y, a.x * b.z - b.x * a.z) / area;
    return area != 0.0 ? slope : vec2(0.0);
}

// Of a sample so far away: five samples' distances wide, as much again as one of them to fade.
float weight(vec2 away) {
    vec2 w = clamp(3.0 - 2.0 * abs(away), 0.0, 1.0);
    return w.x * w.y;
}

float share_seen(ShadowFace face, vec3 position, vec3 facing) {
    Projected p = projected(face, vec4(position, 1.0));
    if (face.size == 0u || p.w <= 0.0) {
        return 1.0;
    }
    vec2 slope = depth_slope(face, p, facing);
    float bias = face.bias + face.bias_share * p.at.z + (abs(slope.x) + abs(slope.y)) / SNAP_STEPS;
    ivec2 corner = ivec2(floor(clamp(p.at.xy, -8.0, float(face.size) + 8.0) - 1.5));
    vec2 sums = vec2(0.0); // of what is seen, and of all
    [[dont_unroll]] for (int k = 0; k < 16; ++k) {
        ivec2 texel = corner + ivec2(k & 3, k >> 2);
        bool inside = all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, ivec2(face.size)));
        vec4 nearest = inside ? LOAD(depths, face.first + uint(texel.y) * face.size + uint(texel.x)) : vec4(0.0);
        for (int s = 0; s < 4; ++s) {
            vec2 away = vec2(texel) + vec2(sample_x(s), sample_y(s)) / 256.0 - p.at.xy;
            float plane = max(p.at.z + dot(slope, away), 0.0);
            sums += weight(away) * vec2(nearest[s] > plane + bias ? 0.0 : 1.0, 1.0);
        }
    }
    return sums.y > 0.0 ? sums.x / sums.y : 1.0;
}

// The side that looks along the direction from a light.
uint side_of(vec3 away) {
    vec3 size = abs(away);
    uint axis = size.x >= size.y && size.x >= size.z ? 0u : (size.y >= size.z ? 1u : 2u);
    return 2u * axis + (away[axis] < 0.0 ? 1u : 0u);
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i / params.lights);
    uint l = i % params.lights;
    Light light = LOAD(lights, l);
    Incoming arriving = incoming(light, point.position);
    vec3 normal = LOAD(appearances, i / params.lights).normal;
    float seen = 0.0;
    bool lit = params.any_normal != 0u || dot(normal, arriving.direction) > 0.0 || normal == vec3(0.0);
    // Behind its own triangle a place is in the triangle's shadow.
    if (lit && (dot(point.facing, arriving.direction) > 0.0 || point.facing == vec3(0.0))) {
        ShadowFace face = LOAD(faces, l * SHADOW_FACES + side_of(-arriving.direction));
        seen = share_seen(face, point.position, point.facing);
    }
    STORE(shadows, i, seen);
}

#include "batch.glsl"
