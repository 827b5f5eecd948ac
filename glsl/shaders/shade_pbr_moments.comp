#version 460
#extension GL_GOOGLE_include_directive : require
#define MOMENTS
#include "shade_pbr.glsl"
