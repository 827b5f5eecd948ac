#version 460
#extension GL_GOOGLE_include_directive : require
// Takes the vertices of one instance to the screen: a thread per vertex.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "snap.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint instance;
    uint vertex_first; // in positions
    uint screen_first; // in screen
    vec2 size_px;      // of the whole image
} params;

PAGED(0, readonly, vec3, positions);
PAGED(1, readonly, vec4, instance_rows);
PAGED(2, writeonly, ivec4, screen);

#include "project.glsl"

void element(uint i) {
    vec4 h = homogeneous(params.instance, LOAD(positions, params.vertex_first + i));
    STORE(screen, params.screen_first + i, screen_vertex(h, params.size_px));
}

#include "batch.glsl"
