#version 460
#extension GL_GOOGLE_include_directive : require
// See raster_medium.glsl: what is covered is seen where it lies between the last layer and what is solid; keys are written by halves.
#define WORDS
#define PEELED
#include "raster_medium.glsl"
