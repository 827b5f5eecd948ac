#version 460
// Adds the bound of one height layer along directions that bend to the bounds of regions; of lines also what they are
// displaced by at their places.
#include "common.glsl"
#include "pages.glsl"
#include "bound.glsl"
#include "bound_facet.glsl"
#include "bound_region.glsl"
#include "bound_field.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint of_lines;   // 0 or 1
    uint accumulate; // 0: the first layer
} params;

PAGED(3, readonly, BoundVertex, bound_vertices);
PAGED(4, readonly, vec4, map_bounds);
PAGED(5, , float, bounds);
PAGED(6, , mat3, displaced); // of lines: a column for each place, local units

// Shortest blended normal a direction is divided by.
const float MIN_BLENDED_NORMAL = 0.125;

BoundVertex vertex_of(const uint av) {
    return LOAD(bound_vertices, av);
}

// Of a line, only the ends count.
mat3 kept(const mat3 m) {
    return params.of_lines != 0u ? mat3(m[0], m[1], m[1]) : m;
}

void displace(const uint i, const mat3 ways, const mat3 corrections, const vec3 heights) {
    mat3 from = corrections;
    if (params.accumulate != 0u) {
        from = LOAD(displaced, i);
    }
    STORE(displaced, i, from + mat3(ways[0] * heights.x, ways[1] * heights.y, ways[2] * heights.z));
}

void element(uint i) {
    Region region = region_of(i, params.of_lines != 0u);
    BoundVertex p = vertex_of(region.av.x), q = vertex_of(region.av.y), r = vertex_of(region.av.z);
    mat3 shares = mat3(vec3(region.a), vec3(region.b), vec3(region.c)) * SHARE;
    mat3 ways = mat3(p.direction, q.direction, r.direction) * shares;
    float curvature = 0.0;
    // The normals of a flat triangle are unit, and so are their blends.
    if (p.normal != q.normal || q.normal != r.normal) {
        mat3 normals = mat3(p.normal, q.normal, r.normal) * shares;
        curvature = quotient_curvature(kept(ways), kept(normals), MIN_BLENDED_NORMAL);
        vec3 lengths = max(vec3(length(normals[0]), length(normals[1]), length(normals[2])), MIN_BLENDED_NORMAL);
        ways = mat3(ways[0] / lengths.x, ways[1] / lengths.y, ways[2] / lengths.z);
    }
    vec4 map = LOAD(map_bounds, i);
    if (params.of_lines != 0u) {
        displace(i, ways, mat3(p.correction, q.correction, r.correction) * shares, map.xyz);
        map.z = map.y;
    }
    float more = product_curvature(Field(kept(ways), curvature), map.xyz, map.w);
    float before = params.accumulate == 0u ? 0.0 : LOAD(bounds, i);
    STORE(bounds, i, before + more);
}

#include "batch.glsl"
