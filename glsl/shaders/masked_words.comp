#version 460
#extension GL_GOOGLE_include_directive : require
// See masked.glsl; keys are written by halves.
#define WORDS
#include "masked.glsl"
