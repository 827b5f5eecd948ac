#version 460
// See subdivide.glsl: over a flat base.
#include "subdivide.glsl"
