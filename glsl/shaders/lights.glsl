// Lights that have a place or a direction (KHR_lights_punctual). Needs `lights` and, where there are shadows, `shadows`
// in scope. Mirrored in layout.rs.
struct Light {
    vec3 position;  // world; of the sun, none
    uint kind;      // LIGHT_*
    vec3 direction; // world, unit: towards a sun; where a spot points
    float range;    // world units; 0: endless
    vec3 color;     // linear: irradiance of a sun (lux), intensity of others (candela)
    float cone_scale; // of a spot: attenuation is clamp(cosine * scale + offset, 0, 1)^2
    float cone_offset;
    float radius;   // world units of a ball that shines, 0: a point
};

const uint LIGHT_SUN = 0u;
const uint LIGHT_POINT = 1u;
const uint LIGHT_SPOT = 2u;

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
    float share = 1.0 / squared;
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
