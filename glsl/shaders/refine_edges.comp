#version 460
// Carries edges over to the next round: marked ones become two with a new vertex between them, a quarter as long
// squared each.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"
#include "keys.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;    // edges
    uint marked;   // of them
    uint vertices; // so far
} params;

PAGED(0, readonly, RefinedEdge, edges);
PAGED(1, readonly, uint, marks);
PAGED(2, readonly, uint, mark_offsets); // exclusive sums of the marks
PAGED(3, readonly, RefineBase, bases);
PAGED(4, readonly, uvec2, base_edges); // gvs of each base ge
PAGED(5, readonly, RefinedVertex, vertices);
PAGED(6, writeonly, RefinedVertex, next_vertices);
PAGED(7, writeonly, RefinedEdge, next_edges);
PAGED(8, writeonly, uint, inexact); // 1 where a middle is no whole number of units

void note(const uint sum) {
    if ((sum & 1u) != 0u) {
        STORE(inexact, 0u, 1u);
    }
}

// Both lie on the base edge, or in the base triangle, that the edge is of.
RefinedVertex midpoint(const RefinedEdge edge, const RefinedVertex a, const RefinedVertex b) {
    if (edge.kind == EDGE) {
        uint first = LOAD(base_edges, edge.owner).x;
        uint sum = along_edge(a, first) + along_edge(b, first);
        note(sum);
        return RefinedVertex(EDGE, edge.owner, uvec2(sum / 2u, 0u));
    }
    RefineBase base = LOAD(bases, edge.owner);
    uvec3 sum = barycentrics(a, base) + barycentrics(b, base);
    note(sum.y | sum.z);
    return RefinedVertex(INTERIOR, edge.owner, sum.yz / 2u);
}

void element(uint i) {
    RefinedEdge edge = LOAD(edges, i);
    uint before = LOAD(mark_offsets, i);
    if (LOAD(marks, i) == 0u) {
        STORE(next_edges, i - before, edge);
        return;
    }
    uint vertex = params.vertices + before;
    STORE(next_vertices, vertex, midpoint(edge, LOAD(vertices, edge.gv.x), LOAD(vertices, edge.gv.y)));
    uint first = params.count - params.marked + 2u * before;
    float quarter = edge.length_square * 0.25;
    uint key = next_key(edge.key, HALF);
    STORE(next_edges, first, RefinedEdge(uvec2(edge.gv.x, vertex), quarter, edge.kind, edge.owner, key));
    STORE(next_edges, first + 1u, RefinedEdge(uvec2(vertex, edge.gv.y), quarter, edge.kind, edge.owner, key));
}

#include "batch.glsl"
