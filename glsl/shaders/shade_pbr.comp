#version 460
#extension GL_GOOGLE_include_directive : require
// Light by the metallic-roughness model (glTF 2.0, appendix B): of lights that have a place or a direction, of an
// environment as `surroundings` has sampled it through the lobe, times a table of albedo, and of surroundings that are
// equally bright all over. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "material.glsl"
#include "appearance.glsl"
#include "lights.glsl"
#include "brdf.glsl"
#include "surroundings.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint lights;
    uint shadowed; // whether `shadows` holds anything
    uint multiple_scattering; // whether facets pass light on to each other
    vec4 eye;      // w = 1: a place; w = 0: the direction towards an orthographic camera
    float ambient; // radiance of white surroundings
    uint has_environment; // whether `surroundings` holds anything
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Appearance, appearances);
PAGED(2, readonly, Light, lights);
PAGED(3, readonly, float, shadows); // of each light, as `arriving_of` reads it, `lights` for each fragment
PAGED(4, readonly, Surroundings, surroundings);
PAGED(5, readonly, vec3, brdf_table);
PAGED(6, writeonly, vec4, radiance);
#include "brdf_light.glsl"

// Share of a reflection that leaves the real surface where its normals are bent by a map.
float above_horizon(vec3 mirrored, vec3 normal) {
    float share = clamp(1.0 + 1.3 * dot(mirrored, normal), 0.0, 1.0);
    return share * share;
}

vec3 from_everywhere(uint i, Reflectance surface, Albedo seen, vec3 n, vec3 v, vec3 smooth_normal) {
    Surroundings sky = Surroundings(vec3(0.0), vec3(0.0), vec3(0.0));
    if (params.has_environment != 0u) {
        sky = LOAD(surroundings, i);
    }
    float share = above_horizon(2.0 * dot(n, v) * n - v, smooth_normal);
    vec3 facing = seen.single - seen.grazing;
    return (facing * (sky.facing + params.ambient) + seen.grazing * (sky.grazing + params.ambient)) * share
        + around(surface, seen) * (sky.diffuse + params.ambient);
}

vec3 shaded(uint i, SurfacePoint point, Appearance a) {
    vec3 v = normalize(params.eye.xyz - params.eye.w * point.position);
    vec3 n = visible_normal(a.normal, v);
    Reflectance surface = reflectance(a.base.rgb, a.metallic, a.roughness);
    bool multiple = params.multiple_scattering != 0u;
    Albedo seen = albedo(surface, clamp(dot(n, v), MIN_COSINE, 1.0), multiple);
    vec3 color = a.emissive + a.occlusion * from_everywhere(i, surface, seen, n, v, point.normal);
    [[dont_unroll]] for (uint l = 0u; l < params.lights; ++l) {
        float stored = params.shadowed != 0u ? LOAD(shadows, i * params.lights + l) : 1.0;
        Light whole = LOAD(lights, l);
        vec2 turn = light_turn(point.pixel, l);
        [[dont_unroll]] for (uint k = 0u; k < light_samples(whole); ++k) {
            float arriving = arriving_of(stored, k);
            Incoming light = incoming_of(whole, point.position, k, turn);
            float cosine = dot(n, light.direction);
            if (arriving > 0.0 && cosine > 0.0) {
                vec3 share = brdf_pi(surface, seen, n, v, light.direction, multiple);
                color += light.irradiance * share * (arriving * cosine / PI);
            }
        }
    }
    return color;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Appearance a = LOAD(appearances, i);
    vec3 color = a.base.rgb;
    if ((a.flags & MATERIAL_UNLIT) == 0u) {
        color = shaded(i, point, a);
    }
    STORE(radiance, i, vec4(color, a.base.a));
}

#include "batch.glsl"
