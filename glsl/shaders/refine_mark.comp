#version 460
// Marks the longest side of triangles that are to be split. As `closing`: of triangles with a marked side, until no
// triangle has a marked side and an unmarked longest one (Rivara 1984).
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;   // triangles
    uint closing; // 0 or 1
} params;

PAGED(0, readonly, RefinedTriangle, triangles);
PAGED(1, readonly, RefinedEdge, edges);
PAGED(2, readonly, uint, wanted); // 1: split this triangle
PAGED(3, , uint, marks);          // of edges, 0 or 1
PAGED(4, writeonly, uint, changed);

uint longest_side(const uvec3 ge) {
    return longest_of(LOAD(edges, ge.x), LOAD(edges, ge.y), LOAD(edges, ge.z));
}

void element(uint i) {
    uvec3 ge = LOAD(triangles, i).ge;
    bool splits;
    if (params.closing == 0u) {
        splits = LOAD(wanted, i) == 1u;
    } else {
        splits = (LOAD(marks, ge.x) | LOAD(marks, ge.y) | LOAD(marks, ge.z)) != 0u;
    }
    if (splits) {
        uint longest = ge[longest_side(ge)];
        if (LOAD(marks, longest) == 0u) {
            // Others may read it before or after, or write the same 1: a mark never goes, and a sweep that changed
            // nothing has read the marks as they stay.
            STORE(marks, longest, 1u);
            STORE(changed, 0u, 1u);
        }
    }
}

#include "batch.glsl"
