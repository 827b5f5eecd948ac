#version 460
#extension GL_GOOGLE_include_directive : require
// Light by Phong's model (1975): of the pixel's normal, of the vertices' and blended (Gouraud 1971), or of the
// triangle's, once (flat); and what mirrors show of an environment (Blinn and Newell 1976). A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "raster_tables.glsl"
#include "material.glsl"
#include "appearance.glsl"
#include "lights.glsl"
#include "surroundings.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint normals;  // NORMALS_*
    uint lights;
    uint shadowed; // whether `shadows` holds anything
    vec4 eye;      // w = 1: a place; w = 0: the direction towards an orthographic camera
    float ambient;
    float reflectivity;   // share of the mirrored surroundings that is added
    uint has_environment; // whether `surroundings` holds anything
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Appearance, appearances);
PAGED(2, readonly, Light, lights);
PAGED(3, readonly, float, shadows); // of each light, as `arriving_of` reads it, `lights` for each fragment
PAGED(4, readonly, vec3, positions);
PAGED(5, readonly, vec3, normals);
PAGED(6, readonly, vec4, instance_rows);
PAGED(7, readonly, Surroundings, surroundings);
PAGED(8, writeonly, vec4, radiance);
#include "world.glsl"

const uint NORMALS_OF_PIXELS = 0u;
const uint NORMALS_OF_VERTICES = 1u;
const uint NORMALS_OF_TRIANGLES = 2u;

// Phong's highlight: share of the light, and exponent.
const float SPECULAR_STRENGTH = 0.2;
const float SPECULAR_EXPONENT = 32.0;
const float ONE_OVER_PI = 0.318309886;

// What a light adds at a place, of white: diffuse in rgb of the first, highlight in the second.
struct Reflected {
    vec3 diffuse;
    vec3 specular;
};

// The k-th sample of a light, as the pixel turns it.
struct Sample {
    uint k;
    vec2 turn;
};

Reflected reflected(Light light, Sample s, vec3 position, vec3 normal) {
    Incoming arriving = incoming_of(light, position, s.k, s.turn);
    float cosine = dot(normal, arriving.direction);
    if (cosine <= 0.0) {
        return Reflected(vec3(0.0), vec3(0.0));
    }
    vec3 to_eye = normalize(params.eye.xyz - params.eye.w * position);
    vec3 mirrored = 2.0 * cosine * normal - arriving.direction;
    float highlight = pow(max(dot(mirrored, to_eye), 0.0), SPECULAR_EXPONENT);
    vec3 scattered = arriving.irradiance * ONE_OVER_PI;
    return Reflected(scattered * cosine, scattered * (SPECULAR_STRENGTH * highlight));
}

// At vertex k of the triangle.
Reflected at_vertex(SurfacePoint point, Light light, Sample s, uint k) {
    uint row = point.instance * INSTANCE_ROWS;
    vec3 position = mapped(row + WORLD_ROW, vec4(LOAD(positions, point.vertices[k]), 1.0));
    vec3 normal = unit_or_zero(mapped(row + NORMAL_ROW, vec4(LOAD(normals, point.vertices[k]), 0.0)));
    return reflected(light, s, position, point.flip * normal);
}

Reflected blended(SurfacePoint point, Light light, Sample s) {
    Reflected sum = Reflected(vec3(0.0), vec3(0.0));
    [[dont_unroll]] for (uint k = 0u; k < 3u; ++k) {
        Reflected corner = at_vertex(point, light, s, k);
        sum.diffuse += point.at[k] * corner.diffuse;
        sum.specular += point.at[k] * corner.specular;
    }
    return sum;
}

vec3 centre(SurfacePoint point) {
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        sum += LOAD(positions, point.vertices[k]) / 3.0;
    }
    return mapped(point.instance * INSTANCE_ROWS + WORLD_ROW, vec4(sum, 1.0));
}

Reflected of_light(SurfacePoint point, vec3 normal, Light light, Sample s) {
    if (params.normals == NORMALS_OF_VERTICES) {
        return blended(point, light, s);
    }
    if (params.normals == NORMALS_OF_TRIANGLES) {
        return reflected(light, s, centre(point), point.facing);
    }
    return reflected(light, s, point.position, normal);
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Appearance a = LOAD(appearances, i);
    vec3 color = a.base.rgb;
    if ((a.flags & MATERIAL_UNLIT) == 0u) {
        color = a.base.rgb * (params.ambient * a.occlusion) + a.emissive;
        if (params.has_environment != 0u) {
            Surroundings sky = LOAD(surroundings, i);
            color += a.occlusion * (a.base.rgb * sky.diffuse + params.reflectivity * sky.facing);
        }
        [[dont_unroll]] for (uint l = 0u; l < params.lights; ++l) {
            float stored = params.shadowed != 0u ? LOAD(shadows, i * params.lights + l) : 1.0;
            Light whole = LOAD(lights, l);
            Sample s = Sample(0u, light_turn(point.pixel, l));
            [[dont_unroll]] for (; s.k < light_samples(whole); ++s.k) {
                float arriving = arriving_of(stored, s.k);
                if (arriving > 0.0) {
                    Reflected light = of_light(point, a.normal, whole, s);
                    color += arriving * (a.base.rgb * light.diffuse + light.specular);
                }
            }
        }
    }
    STORE(radiance, i, vec4(color, a.base.a));
}

#include "batch.glsl"
