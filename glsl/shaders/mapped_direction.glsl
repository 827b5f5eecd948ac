// Directions of the tangent frame as MikkTSpace has it: tangents interpolated, nothing made orthogonal to the normal.
// Include after surface_point.glsl and raster_tables.glsl; needs `tangents` and `instance_rows` in scope.

// Unit tangent and the bitangent, of the front; zero where there is no tangent.
mat2x3 tangent_frame(SurfacePoint point) {
    vec4 tangent = vec4(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        tangent += LOAD(tangents, point.triangle * 3u + k) * point.at[k];
    }
    uint row = point.instance * INSTANCE_ROWS + WORLD_ROW;
    vec3 t;
    for (uint k = 0u; k < 3u; ++k) {
        t[k] = dot(LOAD(instance_rows, row + k).xyz, tangent.xyz);
    }
    float length_squared = dot(t, t);
    if (length_squared < 1e-30 || tangent.w == 0.0) {
        return mat2x3(0.0);
    }
    t *= inversesqrt(length_squared);
    return mat2x3(t, sign(tangent.w) * cross(point.normal * point.flip, t));
}

// Unnormalised; zero where there is no tangent.
vec3 mapped_direction(SurfacePoint point, vec3 n) {
    mat2x3 frame = tangent_frame(point);
    if (frame[0] == vec3(0.0)) {
        return vec3(0.0);
    }
    return point.flip * (n.x * frame[0] + n.y * frame[1] + n.z * (point.normal * point.flip));
}
