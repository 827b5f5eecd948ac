#version 460
#extension GL_GOOGLE_include_directive : require
// See raster_large.glsl: what is covered is counted.
#define COUNTED
#include "raster_large.glsl"
