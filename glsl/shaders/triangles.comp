#version 460
// Fine triangles, wound as their base triangle. Counts those that face against the base triangle and
// those whose positions are not finite.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first; // fine triangle of the first thread
    Lattice lattice;
} params;

PAGED(0, readonly, BaseTriangle, base_triangles);
PAGED(1, readonly, vec3, triangle_facing);
PAGED(2, readonly, vec3, positions);
PAGED(3, writeonly, uvec3, triangles);
PAGED(4, , uint, counters);

const uint FLIPPED = 0u;
const uint NOT_FINITE = 1u;

// The three lattice points of fine triangle `rank` of n²: rows of constant j, upright and inverted
// triangles in turn.
void corners_of(const uint n, const uint rank, out uvec2 a, out uvec2 b, out uvec2 c) {
    uint left = n * n - rank;
    uint rows = uint(integer(ceil(sqrt(float(int(left))))));
    rows -= (rows - 1u) * (rows - 1u) >= left ? 1u : 0u;
    rows += rows * rows < left ? 1u : 0u;
    uint offset = rank - (n * n - rows * rows);
    uint j = n - rows;
    uint i = offset >> 1u;
    bool inverted = (offset & 1u) == 1u;
    a = inverted ? uvec2(i + 1u, j) : uvec2(i, j);
    b = inverted ? uvec2(i + 1u, j + 1u) : uvec2(i + 1u, j);
    c = uvec2(i, j + 1u);
}

void element(uint i) {
    i += params.first;
    uint n = 1u << params.lattice.level;
    uint t = i >> (2u * params.lattice.level);
    BaseTriangle triangle = LOAD(base_triangles, t);
    uvec2 a, b, c;
    corners_of(n, i - t * n * n, a, b, c);
    uvec3 id = uvec3(
        fine_vertex(params.lattice, triangle, t, a.x, a.y),
        fine_vertex(params.lattice, triangle, t, b.x, b.y),
        fine_vertex(params.lattice, triangle, t, c.x, c.y)
    );
    STORE(triangles, i, id);
    vec3 p = LOAD(positions, id.x);
    vec3 q = LOAD(positions, id.y);
    vec3 r = LOAD(positions, id.z);
    // False for NaN as well.
    bool finite = all(lessThan(abs(p) + abs(q) + abs(r), vec3(3e38)));
    float facing = dot(cross(q - p, r - p), LOAD(triangle_facing, t));
    if (!finite) {
        atomicAdd(ELEMENT(counters, NOT_FINITE), 1u);
    } else if (facing < 0.0) {
        atomicAdd(ELEMENT(counters, FLIPPED), 1u);
    }
}

#include "batch.glsl"
