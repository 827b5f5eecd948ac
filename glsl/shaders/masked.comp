#version 460
#extension GL_GOOGLE_include_directive : require
// See masked.glsl.
#include "masked.glsl"
