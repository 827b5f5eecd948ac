// Maps with derivatives: the bilinear value, and slopes as taps.glsl has them. The twin is `reference/map.rs`.
// Include after map.glsl.
#include "taps.glsl"

PAGED(8, readonly, Layer, layers);
PAGED(9, readonly, float, texels);

// Texel-space coordinates as jets.
vec3 texel_space_jet(const vec3 row, const vec3 u, const vec3 v) {
    precise float value = row.x * u.x + row.y * v.x + row.z;
    return vec3(clamp(value, -FARTHEST_TEXEL, FARTHEST_TEXEL), row.x * u.yz + row.y * v.yz);
}
