#version 460
// The vertices of all triangles at touched vertices: their candidates are no longer right.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, Facet, triangles);
PAGED(1, readonly, uint, touched);
PAGED(2, writeonly, uint, around); // 0 before

void element(uint i) {
    uvec3 gv = LOAD(triangles, i).gv;
    if ((LOAD(touched, gv.x) | LOAD(touched, gv.y) | LOAD(touched, gv.z)) != 0u) {
        // Others may write the same 1.
        STORE(around, gv.x, 1u);
        STORE(around, gv.y, 1u);
        STORE(around, gv.z, 1u);
    }
}

#include "batch.glsl"
