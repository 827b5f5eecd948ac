// Where corners of a triangle lie on a level of their material's height map. Needs `uvs`, `relief_levels`,
// params.uv_channels.

// Texels of the level, which is (i, j) in the middle of texel (i, j).
mat3x2 texels_of(Relief relief, uvec3 vertices, uint level) {
    vec2 size = vec2(LOAD(relief_levels, relief.level_first + level).size);
    mat3x2 texels;
    for (int k = 0; k < 3; ++k) {
        vec3 uv = vec3(LOAD(uvs, vertices[k] * params.uv_channels + relief.uv_channel), 1.0);
        texels[k] = vec2(dot(relief.map_u, uv), dot(relief.map_v, uv)) * size - 0.5;
    }
    return texels;
}
