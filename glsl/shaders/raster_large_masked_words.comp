#version 460
#extension GL_GOOGLE_include_directive : require
// See raster_large.glsl: covered samples become fragments, whose alpha `masked_words` tests; keys are written by halves.
#define WORDS
#define MASKED
#include "raster_large.glsl"
