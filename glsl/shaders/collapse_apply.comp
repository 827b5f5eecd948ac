#version 460
// Draws selected vertices into theirs: triangles with both vanish, the others around get the new vertex. No two neighbours
// are selected, so a triangle has one of them at most.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, uint, selected);
PAGED(1, , Facet, triangles);
PAGED(2, writeonly, uint, kept);    // 0 of triangles that vanish, else 1
PAGED(3, writeonly, uint, touched); // 1 of vertices whose candidates are no longer right

void element(uint i) {
    Facet facet = LOAD(triangles, i);
    uvec3 to = uvec3(LOAD(selected, facet.gv.x), LOAD(selected, facet.gv.y), LOAD(selected, facet.gv.z));
    bvec3 goes = notEqual(to, uvec3(NOWHERE));
    uint keep = 1u;
    if (any(goes)) {
        uint target = goes.x ? to.x : (goes.y ? to.y : to.z);
        keep = any(equal(facet.gv, uvec3(target))) ? 0u : 1u;
        // Others may write the same 1.
        STORE(touched, facet.gv.x, 1u);
        STORE(touched, facet.gv.y, 1u);
        STORE(touched, facet.gv.z, 1u);
        STORE(triangles, i, Facet(mix(facet.gv, uvec3(target), goes), facet.base));
    }
    STORE(kept, i, keep);
}

#include "batch.glsl"
