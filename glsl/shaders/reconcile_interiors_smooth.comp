#version 460
// See reconcile_interiors.glsl: over a smooth base.
#define SMOOTH
#include "reconcile_interiors.glsl"
