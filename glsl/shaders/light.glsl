// Lights that have a place or a direction (KHR_lights_punctual), and balls of light around them, which are looked up in
// several directions. Mirrored in layout.rs.
#include "keys.glsl"

struct Light {
    vec3 position;  // world; of the sun, none
    uint kind;      // LIGHT_*
    vec3 direction; // world, unit: towards a sun; where a spot points
    float range;    // world units; 0: endless
    vec3 color;     // linear: irradiance of a sun (lux), intensity of others (candela)
    float cone_scale; // of a spot: attenuation is clamp(cosine * scale + offset, 0, 1)^2
    float cone_offset;
    float radius;   // of a ball that shines, world units; of a sun, the sine of the angle from its middle to its rim; 0: a point
};

const uint LIGHT_SUN = 0u;
const uint LIGHT_POINT = 1u;
const uint LIGHT_SPOT = 2u;

// Directions that a ball of light is looked up in.
const uint LIGHT_SAMPLES = 16u;
const float LIGHT_TURN = 6.28318530718;
const float GOLDEN_ANGLE = 2.39996322973;

uint light_samples(Light light) {
    return light.radius > 0.0 ? LIGHT_SAMPLES : 1u;
}

// In [0, 1) each way: how a pixel (column, and row << 16) turns the directions of light number `l`.
vec2 light_turn(uint pixel, uint l) {
    uint key = mixed(mixed(mixed(pixel & 0xFFFFu) ^ (pixel >> 16)) ^ l);
    return vec2(key >> 8, mixed(key) >> 8) / 16777216.0;
}

// Of the angle from a ball's middle to its rim, whose middle is `way` off; of a sun always the same.
float light_sine(Light light, vec3 way) {
    return light.kind == LIGHT_SUN ? light.radius : light.radius * inversesqrt(max(dot(way, way), light.radius * light.radius));
}

// Unit, towards sample k of a light whose middle is `way` off: the k-th ring of a spiral of as many over its solid angle.
vec3 light_direction(Light light, vec3 way, uint k, vec2 turn) {
    vec3 middle = light.kind == LIGHT_SUN ? light.direction : way * inversesqrt(max(dot(way, way), 1e-20));
    if (light.radius <= 0.0) {
        return middle;
    }
    float sine = light_sine(light, way);
    // 1 - cosine of the direction's own angle.
    float low = (float(k) + turn.x) / float(LIGHT_SAMPLES) * sine * sine / (1.0 + sqrt(max(1.0 - sine * sine, 0.0)));
    float angle = GOLDEN_ANGLE * float(k) + LIGHT_TURN * turn.y;
    vec3 x = normalize(cross(middle, abs(middle.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0)));
    vec3 aside = cos(angle) * x + sin(angle) * cross(middle, x);
    return normalize((1.0 - low) * middle + sqrt(max(low * (2.0 - low), 0.0)) * aside);
}
