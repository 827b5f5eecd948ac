#version 460
#extension GL_GOOGLE_include_directive : require
// What each fragment sees of an environment: by its whole hemisphere, and by the lobe of its roughness, or by a mirror. At
// the pixel's normal, or the triangle's where shading is flat. A thread per fragment.
#include "surroundings_lobe.glsl"

const uint NORMALS_OF_TRIANGLES = 2u;

Surroundings over_lobe(vec3 v, vec3 n, float roughness, float footprint) {
    float cosine = max(dot(n, v), MIN_COSINE);
    mat3 world_from_local = lobe_frame(v, n, cosine);
    vec3 local = in_lobe_frame(cosine);
    float alpha = max(roughness * roughness, MIN_ALPHA);
    LobeSums sums = LobeSums(vec4(0.0), vec4(0.0));
    [[dont_unroll]] for (uint i = 0u; i < params.samples; ++i) {
        add_sample(sums, lobe_sample(local, alpha, i), world_from_local, footprint);
    }
    return of_sums(sums, irradiance_at(n));
}

Surroundings seen(vec3 v, vec3 normal, float roughness, float footprint) {
    vec3 n = visible_normal(normal, v);
    if (params.samples > 0u) {
        return over_lobe(v, n, clamp(roughness, 0.0, 1.0), footprint);
    }
    vec3 mirrored = environment_mirror(2.0 * dot(n, v) * n - v, footprint, params.mips);
    return Surroundings(irradiance_at(n), mirrored, mirrored);
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    bool flat_shaded = params.normals == NORMALS_OF_TRIANGLES;
    vec3 normal = flat_shaded ? point.facing : LOAD(appearances, i).normal;
    View view = view_of(params.eye, point.position);
    float footprint = mirrored_footprint(point, visible_normal(normal, view.towards), view, flat_shaded);
    STORE(surroundings, i, seen(view.towards, normal, LOAD(appearances, i).roughness, footprint));
}

#include "batch.glsl"
