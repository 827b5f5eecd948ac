#version 460
// See reconcile_edges.glsl: over a flat base.
#include "reconcile_edges.glsl"
