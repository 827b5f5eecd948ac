#version 460
#extension GL_GOOGLE_include_directive : require
// Where a ray goes that asks whether sample k of a light is seen: nowhere from what faces away, and where a light has no
// such sample. A thread per fragment and light. With the first of them, shadows begin as seeing nothing.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "appearance.glsl"
#include "light.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // fragments x lights
    uint lights;
    uint k;
    uint any_normal; // whether light counts that the pixel's own normal faces away from
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Appearance, appearances);
PAGED(2, readonly, Light, lights);
PAGED(3, writeonly, vec4, aims);     // direction, and how far; 0: nowhere
PAGED(4, writeonly, float, shadows); // as `arriving_of` reads it

// How far the surface of a ball is in the direction of one of its samples, its middle being `way` off. Next to nothing in
// the ball itself: there nothing is in between.
float reach(Light light, vec3 way, vec3 direction) {
    if (light.kind == LIGHT_SUN || light.radius <= 0.0) {
        return light.kind == LIGHT_SUN ? 3.0e38 : length(way);
    }
    float along = dot(way, direction);
    vec3 aside = way - along * direction;
    return max(along - sqrt(max(light.radius * light.radius - dot(aside, aside), 0.0)), 1e-30);
}

void element(uint i) {
    uint fragment = i / params.lights;
    uint l = i % params.lights;
    SurfacePoint point = LOAD(points, fragment);
    Light light = LOAD(lights, l);
    vec3 normal = LOAD(appearances, fragment).normal;
    vec3 way = light.position - point.position;
    vec3 direction = light_direction(light, way, params.k, light_turn(point.pixel, l));
    bool faces = params.any_normal != 0u || dot(normal, direction) > 0.0 || normal == vec3(0.0);
    bool asks = faces && params.k < light_samples(light);
    STORE(aims, i, vec4(direction, asks ? reach(light, way, direction) : 0.0));
    if (params.k == 0u) {
        STORE(shadows, i, light.radius > 0.0 ? -1.0 : 0.0);
    }
}

#include "batch.glsl"
