#version 460
// See jets_vector.glsl: over a flat base.
#include "jets_vector.glsl"
