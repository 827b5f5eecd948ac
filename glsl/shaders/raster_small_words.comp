#version 460
#extension GL_GOOGLE_include_directive : require
// See raster_small.glsl: what is covered is seen; keys are written by halves.
#define WORDS
#include "raster_small.glsl"
