#version 460
#extension GL_GOOGLE_include_directive : require
// Light by the metallic-roughness model: of all normals that each fragment covers.
#define MOMENTS
#include "shade_pbr.glsl"
