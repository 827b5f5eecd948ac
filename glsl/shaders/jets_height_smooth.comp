#version 460
// See jets_height.glsl: over a smooth base.
#define SMOOTH
#include "jets_height.glsl"
