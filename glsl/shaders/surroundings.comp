#version 460
#extension GL_GOOGLE_include_directive : require
// What each fragment sees of an environment: by its whole hemisphere, and by the lobe of its roughness, or by a mirror. At
// the pixel's normal, or the triangle's where shading is flat. A thread per fragment.
#include "surroundings_lobe.glsl"

const uint NORMALS_OF_TRIANGLES = 2u;

// By a mirror where there are no samples: one, that all of Fresnel sees.
Surroundings seen(vec3 position, vec3 v, vec3 normal, float roughness, float footprint) {
    vec3 n = visible_normal(normal, v);
    float cosine = max(dot(n, v), MIN_COSINE);
    mat3 world_from_local = lobe_frame(v, n, cosine);
    vec3 local = in_lobe_frame(cosine);
    float alpha = max(roughness * roughness, MIN_ALPHA);
    LobeSums sums = LobeSums(vec4(0.0), vec4(0.0));
    [[dont_unroll]] for (uint i = 0u; i < max(params.samples, 1u); ++i) {
        LobeSample s = LobeSample(vec3(-local.x, 0.0, local.z), 1.0, 0.5, 0.0);
        if (params.samples > 0u) {
            s = lobe_sample(local, alpha, i);
        }
        add_sample(sums, position, s, world_from_local, footprint);
    }
    return of_sums(sums, irradiance_at(n));
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    if (!is_seen_by(point.material)) {
        return;
    }
    bool flat_shaded = params.normals == NORMALS_OF_TRIANGLES;
    vec3 normal = flat_shaded ? point.facing : LOAD(appearances, i).normal;
    View view = view_of(params.eye, point.position);
    float footprint = mirrored_footprint(point, visible_normal(normal, view.towards), view, flat_shaded);
    STORE(surroundings, i, seen(point.position, view.towards, normal, clamp(LOAD(appearances, i).roughness, 0.0, 1.0), footprint));
}

#include "batch.glsl"
