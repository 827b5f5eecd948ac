#version 460
#extension GL_GOOGLE_include_directive : require
// See raster_small.glsl: what is covered is counted.
#define COUNTED
#include "raster_small.glsl"
