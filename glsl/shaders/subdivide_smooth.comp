#version 460
// See subdivide.glsl: over a smooth base.
#define SMOOTH
#include "subdivide.glsl"
