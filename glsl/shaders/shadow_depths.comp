#version 460
#extension GL_GOOGLE_include_directive : require
// Depths of a light's map from what a slab of it sees: a thread per texel, four samples each; 0 where nothing is.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // texels of the slab
    ivec2 slab_px;
    ivec2 slab_size_px;
    uint first; // texel of the map's side in `depths`
    uint size;  // of the side, texels
} params;

PAGED(0, readonly, uint64_t, visibility);
PAGED(1, writeonly, vec4, depths);

void element(uint i) {
    uint width = uint(params.slab_size_px.x);
    uvec2 texel = uvec2(params.slab_px) + uvec2(i % width, i / width);
    vec4 nearest;
    for (uint s = 0u; s < 4u; ++s) {
        nearest[s] = uintBitsToFloat(uint(LOAD(visibility, i * 4u + s) >> 32));
    }
    STORE(depths, params.first + texel.y * params.size + texel.x, nearest);
}

#include "batch.glsl"
