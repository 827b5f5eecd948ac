#version 460
// See jets_vector.glsl: over a smooth base.
#define SMOOTH
#include "jets_vector.glsl"
