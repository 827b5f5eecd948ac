#version 460
// See jets_height.glsl: over a flat base.
#include "jets_height.glsl"
