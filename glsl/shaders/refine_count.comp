#version 460
// How many edges inside each triangle its marked sides bring: as many as it has marked sides, and as many further
// triangles.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // triangles
} params;

PAGED(0, readonly, RefinedTriangle, triangles);
PAGED(1, readonly, uint, marks);
PAGED(2, writeonly, uint, splits);

void element(uint i) {
    uvec3 ge = LOAD(triangles, i).ge;
    STORE(splits, i, LOAD(marks, ge.x) + LOAD(marks, ge.y) + LOAD(marks, ge.z));
}

#include "batch.glsl"
