#version 460
// See normals_analytic.glsl: over a flat base.
#include "normals_analytic.glsl"
