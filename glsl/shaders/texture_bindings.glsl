// What every pass that filters maps is bound to; see texture_pass.glsl. Include after common.glsl.
#include "pages.glsl"
#include "surface_point.glsl"
#include "texel_pair.glsl"
#include "texture_use.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform TextureParams {
    uint count;       // fragments
    uint slot;        // MAP_*
    uint uv_channels; // of each vertex
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, TextureUse, maps);
PAGED(2, readonly, vec2, uvs);
PAGED(3, readonly, uvec4, levels);
PAGED(4, readonly, TexelPair, texels);
// The value of the map at each fragment; white where there is none.
PAGED(5, writeonly, vec4, mapped);
#include "texture.glsl"
