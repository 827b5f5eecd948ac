#version 460
// Normals from the finished triangles: each facet weighted by sin(angle) / (product of its two edges'
// lengths) (Max 1999), over the base triangles that meet smoothly at the vertex.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first; // fine vertex of the first thread
    uint block;
    Lattice lattice;
} params;

PAGED(6, readonly, uint, contribution_first); // lists of contributions per av, then per ae
PAGED(7, readonly, uint, contributions);      // triangle * 3 + corner or side
PAGED(8, readonly, vec3, positions);
PAGED(9, writeonly, vec3, normals);

// Lattice neighbours of (i, j), anticlockwise, as (i, j) + 1.
const uvec2 NEIGHBOURS[7] = uvec2[7](
    uvec2(2u, 1u), uvec2(1u, 2u), uvec2(0u, 2u), uvec2(0u, 1u), uvec2(1u, 0u), uvec2(2u, 0u), uvec2(2u, 1u)
);

// Sum of the facets of base triangle t around lattice point ij, on the side of the shading normals.
vec3 facets_around(const uint t, const uvec2 ij) {
    uint n = 1u << params.lattice.level;
    BaseTriangle triangle = LOAD(base_triangles, t);
    vec3 sum = vec3(0.0);
    vec3 centre = vec3(0.0);
    vec3 before = vec3(0.0);
    bool before_inside = false;
    [[dont_unroll]] for (int k = -1; k < 7; ++k) {
        // Off the triangle an unsigned coordinate wraps and fails the test.
        uvec2 at = k < 0 ? ij : ij + NEIGHBOURS[max(k, 0)] - 1u;
        bool inside = at.x <= n && at.y <= n && at.x + at.y <= n;
        vec3 edge = vec3(0.0);
        if (inside) {
            vec3 p = LOAD(positions, fine_vertex(params.lattice, triangle, t, at.x, at.y));
            centre = k < 0 ? p : centre;
            edge = p - centre;
        }
        float weight = dot(edge, edge) * dot(before, before);
        if (k > 0 && inside && before_inside && weight > 0.0) {
            sum += cross(before, edge) / weight;
        }
        before = edge;
        before_inside = inside;
    }
    vec3 p0 = position_u(triangle.av.x).xyz;
    vec3 plane = cross(position_u(triangle.av.y).xyz - p0, position_u(triangle.av.z).xyz - p0);
    vec3 shading = normal_of(triangle.av.x) + normal_of(triangle.av.y) + normal_of(triangle.av.z);
    return dot(plane, shading) < 0.0 ? -sum : sum;
}

// Facets of one base triangle around the vertex: `item` is its corner, or its side at point `along`.
vec3 facets_of(const uint item, uint along) {
    uint n = 1u << params.lattice.level;
    uint t = item / 3u;
    uint k = item - 3u * t;
    bool reversed = (LOAD(base_triangles, t).reversed >> k & 1u) == 1u;
    along = reversed && along > 0u ? n - along : along;
    uint left = n - along;
    return facets_around(t, k == 0u ? uvec2(along, 0u) : (k == 1u ? uvec2(left, along) : uvec2(0u, left)));
}

vec3 gathered(const uint list, const uint along) {
    vec3 sum = vec3(0.0);
    uint end = LOAD(contribution_first, list + 1u);
    [[dont_unroll]] for (uint item = LOAD(contribution_first, list); item < end; ++item) {
        sum += facets_of(LOAD(contributions, item), along);
    }
    return sum;
}

void element(uint i) {
    uint n = 1u << params.lattice.level;
    vec3 sum;
    if (params.block == INTERIORS) {
        uint points = interior_points(n);
        sum = facets_around(i / points, interior_point(n, i % points));
    } else if (params.block == EDGES) {
        sum = gathered(params.lattice.corners + i / (n - 1u), i % (n - 1u) + 1u);
    } else {
        sum = gathered(i, 0u);
    }
    Site site = site_of(params.lattice, params.block, i);
    vec3 base = blend(site.b, normal_of(site.av.x), normal_of(site.av.y), normal_of(site.av.z));
    float size = length(sum);
    STORE(normals, i + params.first, size > 0.0 && size < 3e38 ? sum / size : normalize(base));
}

#include "batch.glsl"
