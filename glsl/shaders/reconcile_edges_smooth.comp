#version 460
// See reconcile_edges.glsl: over a smooth base.
#define SMOOTH
#include "reconcile_edges.glsl"
