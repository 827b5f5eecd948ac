#version 460
// See jets_expression.glsl: over a smooth base.
#define SMOOTH
#include "jets_expression.glsl"
