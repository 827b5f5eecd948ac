#version 460
#extension GL_GOOGLE_include_directive : require
// What each fragment sees of an environment where many normals lie under it: each sample of the lobe has a normal of its
// own. A thread per fragment.
#include "surroundings_lobe.glsl"
#include "spread.glsl"

PAGED(8, readonly, Spread, spreads);

const float PLASTIC_TURN = 4.74303625;

// A normal of the Gaussian of slopes for each sample (Box and Muller 1958, by a set that is even over both).
vec3 sampled_normal(vec3 n, Spread spread, uint i) {
    float u = float(bitfieldReverse(i)) * (1.0 / 4294967296.0) + 0.5 / float(params.samples);
    float radius = sqrt(-2.0 * log(1.0 - u));
    float turn = PLASTIC_TURN * float(i);
    return normalize(n + radius * (cos(turn) * spread.major + sin(turn) * spread.minor));
}

// Solid angle that the normals add to what a sample fills of the mirrored lobe seen head on.
float added_area(Spread spread, float alpha) {
    vec2 variance = vec2(dot(spread.major, spread.major), dot(spread.minor, spread.minor));
    vec2 wider = 2.0 * variance + alpha * alpha;
    return 4.0 * PI / float(params.samples) * (sqrt(wider.x * wider.y) - alpha * alpha);
}

Surroundings over_normals(vec3 position, vec3 v, vec3 n, Spread spread, float roughness, float footprint) {
    float alpha = max(roughness * roughness, MIN_ALPHA);
    float added = added_area(spread, alpha);
    vec3 diffuse = vec3(0.0);
    LobeSums sums = LobeSums(vec4(0.0), vec4(0.0));
    [[dont_unroll]] for (uint i = 0u; i < params.samples; ++i) {
        vec3 tilted = visible_normal(sampled_normal(n, spread, i), v);
        float cosine = max(dot(tilted, v), MIN_COSINE);
        LobeSample s = lobe_sample(in_lobe_frame(cosine), alpha, i);
        s.width = sqrt(s.width * s.width + cosine * added);
        add_sample(sums, position, s, lobe_frame(v, tilted, cosine), footprint);
        diffuse += irradiance_at(tilted) / float(params.samples);
    }
    return of_sums(sums, diffuse);
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    if (!is_seen_by(point.material)) {
        return;
    }
    View view = view_of(params.eye, point.position);
    vec3 n = visible_normal(LOAD(appearances, i).normal, view.towards);
    float footprint = mirrored_footprint(point, n, view, false);
    float roughness = clamp(LOAD(appearances, i).roughness, 0.0, 1.0);
    vec3 at = point.position;
    STORE(surroundings, i, over_normals(at, view.towards, n, LOAD(spreads, i), roughness, footprint));
}

#include "batch.glsl"
