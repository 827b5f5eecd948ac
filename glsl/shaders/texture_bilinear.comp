#version 460
#extension GL_GOOGLE_include_directive : require
// Maps by four texels of their finest level.
#include "common.glsl"
#include "texture_bindings.glsl"

vec4 filtered(TextureUse map, vec2 uv, vec2 uv_dx, vec2 uv_dy) {
    return bilinear(LOAD(levels, map.level_first), uv, wraps_of(map));
}

#include "texture_pass.glsl"
