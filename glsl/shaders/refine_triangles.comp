#version 460
// Carries triangles over to the next round. A triangle with marked sides is halved across the longest, which is one
// of them; then each half across its own marked side.
#include "common.glsl"
#include "pages.glsl"
#include "refine.glsl"
#include "keys.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;        // triangles
    uint edges;        // before this round
    uint marked;       // of them
    uint vertices;     // before this round
} params;

PAGED(0, readonly, RefinedTriangle, triangles);
PAGED(1, readonly, RefinedEdge, edges);
PAGED(2, readonly, uint, marks);
PAGED(3, readonly, uint, mark_offsets);
PAGED(4, readonly, uint, split_offsets); // exclusive sums of the triangles' marked sides
PAGED(5, readonly, RefineBase, bases);
PAGED(6, readonly, vec3, base_positions); // of base gvs
PAGED(7, readonly, RefinedVertex, vertices); // the new ones too
PAGED(8, readonly, uint, states);
PAGED(9, writeonly, RefinedEdge, next_edges);
PAGED(10, writeonly, RefinedTriangle, next_triangles);
PAGED(11, writeonly, uint, next_states); // 0 of new triangles

// What a side becomes: itself under its new number, or two and the vertex between them.
struct Side {
    bool marked;
    uint vertex;
    uint whole;
    uvec2 halves; // from the side's start, to its end
    uint key;     // of the side before
};

Side side_of(const uint ge, const uint start) {
    uint before = LOAD(mark_offsets, ge);
    RefinedEdge edge = LOAD(edges, ge);
    if (LOAD(marks, ge) == 0u) {
        return Side(false, 0u, ge - before, uvec2(0u), edge.key);
    }
    uint first = params.edges - params.marked + 2u * before;
    uvec2 halves = edge.gv.x == start ? uvec2(first, first + 1u) : uvec2(first + 1u, first);
    return Side(true, params.vertices + before, 0u, halves, edge.key);
}

uint longest_side(const uvec3 ge) {
    return longest_of(LOAD(edges, ge.x), LOAD(edges, ge.y), LOAD(edges, ge.z));
}

RefineBase base;
uint base_id;
uint next_edge;
uint next_triangle;

vec3 base_position(const uint vertex) {
    vec3 b = vec3(barycentrics(LOAD(vertices, vertex), base)) * (1.0 / 16777216.0);
    precise vec3 position = b.x * LOAD(base_positions, base.gv.x) + b.y * LOAD(base_positions, base.gv.y)
        + b.z * LOAD(base_positions, base.gv.z);
    return position;
}

uint inner_edge(const uint a, const uint b, const uint key) {
    vec3 d = base_position(a) - base_position(b);
    precise float square = d.x * d.x + d.y * d.y + d.z * d.z;
    STORE(next_edges, next_edge, RefinedEdge(uvec2(a, b), square, INTERIOR, base_id, key));
    return next_edge++;
}

void put(const uvec3 gv, const uvec3 ge) {
    STORE(next_triangles, next_triangle, RefinedTriangle(gv, ge, base_id));
    STORE(next_states, next_triangle, 0u);
    ++next_triangle;
}

// Triangle (p, q, m), of which pq is a side of the whole, qm and mp are known.
void put_half(const uint p, const uint q, const uint m, const Side side, const uint qm, const uint mp) {
    if (!side.marked) {
        put(uvec3(p, q, m), uvec3(side.whole, qm, mp));
        return;
    }
    uint x = side.vertex;
    uint xm = inner_edge(x, m, next_key(side.key, BETWEEN));
    put(uvec3(p, x, m), uvec3(side.halves.x, xm, mp));
    put(uvec3(x, q, m), uvec3(side.halves.y, qm, xm));
}

void element(uint i) {
    RefinedTriangle triangle = LOAD(triangles, i);
    uint before = LOAD(split_offsets, i);
    base_id = triangle.base;
    next_triangle = i + before;
    next_edge = params.edges + params.marked + before;
    uvec3 gv = triangle.gv;
    uint k = longest_side(triangle.ge);
    uvec3 ge = triangle.ge;
    gv = k == 0u ? gv : (k == 1u ? gv.yzx : gv.zxy);
    ge = k == 0u ? ge : (k == 1u ? ge.yzx : ge.zxy);
    Side base_side = side_of(ge.x, gv.x);
    Side right = side_of(ge.y, gv.y);
    Side left = side_of(ge.z, gv.z);
    if (!base_side.marked) {
        // Its sides keep their order, so that an untouched triangle stays as it is.
        uvec3 whole = uvec3(base_side.whole, right.whole, left.whole);
        whole = k == 0u ? whole : (k == 1u ? whole.zxy : whole.yzx);
        STORE(next_triangles, next_triangle, RefinedTriangle(triangle.gv, whole, base_id));
        STORE(next_states, next_triangle, LOAD(states, i));
        return;
    }
    base = LOAD(bases, base_id);
    uint m = base_side.vertex;
    uint c = inner_edge(m, gv.z, next_key(base_side.key, ACROSS));
    put_half(gv.z, gv.x, m, left, base_side.halves.x, c);
    put_half(gv.y, gv.z, m, right, c, base_side.halves.y);
}

#include "batch.glsl"
