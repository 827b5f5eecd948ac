#version 460
// Makes the flips that both of their triangles want most.
#include "common.glsl"
#include "pages.glsl"
#include "facet.glsl"
#include "flip.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, Flip, flips);
PAGED(1, readonly, uint, choices);
PAGED(2, , Facet, triangles);
PAGED(3, writeonly, uint, touched); // 1 of vertices whose triangles changed
PAGED(4, writeonly, uint, changed); // 1 where any did

void element(uint i) {
    uint side = LOAD(choices, i);
    if (side == NOWHERE || side / 3u != i) {
        return;
    }
    Flip flip = LOAD(flips, side);
    if (LOAD(choices, flip.other) != side) {
        return;
    }
    Facet own = LOAD(triangles, i);
    uvec3 abc = turned(own.gv, side - 3u * i);
    STORE(triangles, i, Facet(first_after(abc, flip.d), own.base));
    STORE(triangles, flip.other, Facet(second_after(abc, flip.d), own.base));
    // Others may write the same 1.
    STORE(touched, abc.x, 1u);
    STORE(touched, abc.y, 1u);
    STORE(touched, abc.z, 1u);
    STORE(touched, flip.d, 1u);
    STORE(changed, 0u, 1u);
}

#include "batch.glsl"
