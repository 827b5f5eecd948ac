#version 460
// See normals_analytic.glsl: over a smooth base.
#define SMOOTH
#include "normals_analytic.glsl"
