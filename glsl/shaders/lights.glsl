// What arrives of lights. Needs `lights` and, where there are shadows, `shadows` in scope.
#include "light.glsl"

// What arrives at a place if nothing is in between.
struct Incoming {
    vec3 direction;  // unit, towards the light
    vec3 irradiance; // on a surface that faces the light
};

Incoming incoming(Light light, vec3 position) {
    if (light.kind == LIGHT_SUN) {
        return Incoming(light.direction, light.color);
    }
    vec3 way = light.position - position;
    float squared = max(dot(way, way), 1e-20);
    vec3 direction = way * inversesqrt(squared);
    // Not inside of a ball.
    float share = 1.0 / max(squared, light.radius * light.radius);
    if (light.range > 0.0) {
        float near = squared / (light.range * light.range);
        share *= clamp(1.0 - near * near, 0.0, 1.0);
    }
    if (light.kind == LIGHT_SPOT) {
        float inside = clamp(-dot(light.direction, direction) * light.cone_scale + light.cone_offset, 0.0, 1.0);
        share *= inside * inside;
    }
    return Incoming(direction, light.color * share);
}

// What arrives from sample k of a light: it is as bright all over, so that a plane which faces a ball takes what it takes
// of a point.
Incoming incoming_of(Light light, vec3 position, uint k, vec2 turn) {
    Incoming all = incoming(light, position);
    if (light.radius <= 0.0) {
        return all;
    }
    vec3 way = light.position - position;
    float sine = light_sine(light, way);
    float cosine = sqrt(max(1.0 - sine * sine, 0.0));
    vec3 direction = light_direction(light, way, k, turn);
    return Incoming(direction, all.irradiance * (2.0 / ((1.0 + cosine) * float(LIGHT_SAMPLES))));
}

// What of sample k arrives: `stored` is the share of the whole light, or below 0 holds a bit for each sample.
float arriving_of(float stored, uint k) {
    return stored < 0.0 ? float((uint(-1.0 - stored) >> k) & 1u) : stored;
}
