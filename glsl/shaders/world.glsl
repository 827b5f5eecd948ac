// From a mesh to the world. Include after raster_tables.glsl; needs `instance_rows` in scope.

// Three rows applied to a vector.
vec3 mapped(uint row, vec4 v) {
    vec3 result;
    for (uint k = 0u; k < 3u; ++k) {
        result[k] = dot(LOAD(instance_rows, row + k), v);
    }
    return result;
}

vec3 unit_or_zero(vec3 v) {
    float squared = dot(v, v);
    return squared > 1e-30 && squared < 1e30 ? v * inversesqrt(squared) : vec3(0.0);
}
