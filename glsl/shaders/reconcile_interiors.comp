#version 460
// See reconcile_interiors.glsl: over a flat base.
#include "reconcile_interiors.glsl"
