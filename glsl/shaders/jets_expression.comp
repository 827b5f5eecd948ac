#version 460
// See jets_expression.glsl: over a flat base.
#include "jets_expression.glsl"
