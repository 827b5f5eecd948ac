#version 460
#extension GL_GOOGLE_include_directive : require
// Light by the metallic-roughness model: of one normal for each fragment.
#include "shade_pbr.glsl"
