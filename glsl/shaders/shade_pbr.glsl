// Light by the metallic-roughness model (glTF 2.0, appendix B): of lights that have a place or a direction, of an
// environment as `surroundings` has sampled it through the lobe, times a table of albedo, and of surroundings that are
// equally bright all over. A thread per fragment.
// With MOMENTS, lights meet all normals that a fragment covers.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "material.glsl"
#include "appearance.glsl"
#include "lights.glsl"
#include "brdf.glsl"
#include "surroundings.glsl"
#ifdef MOMENTS
#include "spread.glsl"
#include "lobe_of_normals.glsl"
#endif

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform ShadePbrParams {
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
#ifdef MOMENTS
PAGED(7, readonly, Spread, spreads);
#endif
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

#ifdef MOMENTS
// Light from `l` that leaves towards `v`, times pi and the light's cosine: of all normals that the fragment covers.
vec3 reflected_pi(uint i, Reflectance surface, Albedo seen, vec3 n, vec3 v, vec3 l, bool multiple) {
    Scatter normals = scatter_of(n, LOAD(spreads, i));
    vec3 h = normalize(v + l);
    float cosine = clamp(dot(n, l), 0.0, 1.0);
    float lobe = 0.0;
    if (!is_one_normal(normals, surface.alpha)) {
        cosine = cosine_of_normals(normals, l);
        lobe = PI * lobe_of_normals(normals, surface.alpha, v, l, h);
    } else if (cosine > 0.0) {
        lobe = lobe_pi(surface.alpha, n, v, h, cosine) * cosine;
    }
    float grazed = grazing(dot(v, h));
    Beside beside = beside_pi(surface, seen, grazed, clamp(cosine, MIN_COSINE, 1.0), multiple);
    return fresnel_of(surface, grazed) * lobe + (beside.multiple + beside.below) * cosine;
}
#else
// Share of light from `l` that leaves towards `v`, per steradian, times pi; all unit, `n` as `visible_normal` has it, `l`
// in front of the surface. `seen`: the albedo towards `v`.
vec3 brdf_pi(Reflectance surface, Albedo seen, vec3 n, vec3 v, vec3 l, bool multiple) {
    float nl = min(dot(n, l), 1.0);
    vec3 h = normalize(v + l);
    float lobe = lobe_pi(surface.alpha, n, v, h, nl);
    float grazed = grazing(dot(v, h));
    Beside beside = beside_pi(surface, seen, grazed, nl, multiple);
    return fresnel_of(surface, grazed) * lobe + beside.multiple + beside.below;
}
#endif

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
#ifdef MOMENTS
            if (arriving > 0.0) {
                vec3 share = reflected_pi(i, surface, seen, n, v, light.direction, multiple);
                color += light.irradiance * share * (arriving / PI);
            }
#else
            float cosine = dot(n, light.direction);
            if (arriving > 0.0 && cosine > 0.0) {
                vec3 share = brdf_pi(surface, seen, n, v, light.direction, multiple);
                color += light.irradiance * share * (arriving * cosine / PI);
            }
#endif
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
