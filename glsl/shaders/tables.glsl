// The base mesh as every geometry pass reads it. Include after pages.glsl and lattice.glsl.

PAGED(0, readonly, vec4, av_position_u);
PAGED(1, readonly, vec4, av_direction_v);
PAGED(2, readonly, vec3, av_normal);
PAGED(3, readonly, vec4, av_tangent);
PAGED(4, readonly, BaseEdge, base_edges);
PAGED(5, readonly, BaseTriangle, base_triangles);

#include "site.glsl"

vec2 blend(const vec3 b, const vec2 x, const vec2 y, const vec2 z) {
    precise vec2 sum = b.x * x + b.y * y + b.z * z;
    return sum;
}

vec3 blend(const vec3 b, const vec3 x, const vec3 y, const vec3 z) {
    precise vec3 sum = b.x * x + b.y * y + b.z * z;
    return sum;
}

vec4 blend(const vec3 b, const vec4 x, const vec4 y, const vec4 z) {
    precise vec4 sum = b.x * x + b.y * y + b.z * z;
    return sum;
}

// Each table's load is written once: a load of a paged stream is long.
vec4 position_u(const uint av) {
    return LOAD(av_position_u, av);
}

vec4 direction_v(const uint av) {
    return LOAD(av_direction_v, av);
}

vec3 normal_of(const uint av) {
    return LOAD(av_normal, av);
}

vec4 tangent_of(const uint av) {
    return LOAD(av_tangent, av);
}

// The base position on an edge: the same bits for every attribute edge of a geometric edge.
vec3 edge_position(const uint edge, const float t) {
    Site site = edge_site(edge, t);
    vec3 to = position_u(site.av.y).xyz;
    return blend(site.b, position_u(site.av.x).xyz, to, to);
}
