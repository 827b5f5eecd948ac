// A pass that filters one map slot of each fragment: included last by `texture_FILTER.comp`, which defines
//   vec4 filtered(TextureUse map, vec2 uv, vec2 uv_dx, vec2 uv_dy)   uv of the map, derivatives per pixel
// after including common.glsl, pages.glsl and the bindings below by `texture_bindings.glsl`. A thread per fragment.

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    TextureUse map = LOAD(maps, point.material * MAP_SLOTS + params.slot);
    if (map.level_count == 0u) {
        STORE(mapped, i, vec4(1.0));
        return;
    }
    mat3x2 corner;
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(uvs, point.vertices[k] * params.uv_channels + map.uv_channel);
    }
    mat2x3 rows = mat2x3(map.map_u, map.map_v);
    vec2 uv = vec3(corner * point.at, 1.0) * rows;
    vec2 uv_dx = vec3(corner * point.at_dx, 0.0) * rows;
    vec2 uv_dy = vec3(corner * point.at_dy, 0.0) * rows;
    STORE(mapped, i, filtered(map, uv, uv_dx, uv_dy));
}

#include "batch.glsl"
