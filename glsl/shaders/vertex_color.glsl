// Colours of vertices, blended. Include after surface_point.glsl.

// White stays white, though the weights add up to 1 only up to rounding.
vec4 blended_color(vec4 a, vec4 b, vec4 c, vec3 weights) {
    return a == b && a == c ? a : a * weights.x + b * weights.y + c * weights.z;
}

// Needs `colors` in scope.
#define VERTEX_COLOR(POINT) \
    blended_color( \
        LOAD(colors, POINT.vertices.x), LOAD(colors, POINT.vertices.y), LOAD(colors, POINT.vertices.z), POINT.at)
