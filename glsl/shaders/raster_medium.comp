#version 460
#extension GL_GOOGLE_include_directive : require
// See raster_medium.glsl: what is covered is seen.
#include "raster_medium.glsl"
