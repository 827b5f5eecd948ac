// Normals of the displaced surface itself, not of its triangles: the cross product of its derivatives,
// averaged over the base triangles that meet smoothly at the vertex. Without displacement the shading
// normal stays as it was.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#include "frame.glsl"
#include "sample.glsl"
#ifdef SMOOTH
#include "fields.glsl"

PAGED(13, readonly, Fields, fields); // of the samples
#endif

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint start;        // number of the first thread's vertex in its block
    uint first_sample; // number of the first jet
    uint block;
    Lattice lattice;
} params;

PAGED(6, readonly, uint, triangle_order);
PAGED(7, readonly, uint, contribution_first); // lists of contributions per av, then per ae
PAGED(8, readonly, Sample, samples);          // each at its own triangle
PAGED(9, readonly, mat3, jets);
PAGED(10, writeonly, vec3, normals);
// Of block PLACES: each vertex's first sample, with the end after the last, and its fine number.
PAGED(11, readonly, uint, place_first);
PAGED(12, readonly, uint, place_vertices);

const uint PLACES = 5u;

// Unit normal of the displaced triangle at a sample, on the side of the shading normal; zero where there
// is none. Sets `base` to the shading normal there.
vec3 displaced_normal(const uint i, inout bool moved, out vec3 base) {
    Sample place = LOAD(samples, i);
    mat3 d = LOAD(jets, i);
    vec3 b = vec3(1.0 - place.b.x - place.b.y, place.b);
#ifdef SMOOTH
    Fields own = LOAD(fields, i);
    base = own.normal[0];
    vec3 p1 = own.position[1];
    vec3 p2 = own.position[2];
#else
    base = blend(b, normal_of(place.av.x), normal_of(place.av.y), normal_of(place.av.z));
    vec3 p0 = position_u(place.av.x).xyz;
    vec3 p1 = position_u(place.av.y).xyz - p0;
    vec3 p2 = position_u(place.av.z).xyz - p0;
#endif
    vec3 n = normalize(base);
    moved = moved || d != mat3(0.0);
    // The base's derivatives, in the plane of its shading normal.
    vec3 along1 = p1 - n * dot(n, p1) + d[1];
    vec3 along2 = p2 - n * dot(n, p2) + d[2];
    vec3 normal = cross(along1, along2) * sign(dot(cross(p1, p2), n));
    float size = length(normal);
    // False for NaN as well.
    return size > 0.0 && size < 3e38 ? normal / size : vec3(0.0);
}

// First and last + 1 sample of a vertex; `vertex` is its fine number.
uvec2 samples_of(const uint index, out uint vertex) {
    uint n = 1u << params.lattice.level;
    if (params.block == PLACES) {
        vertex = LOAD(place_vertices, index);
        return uvec2(LOAD(place_first, index), LOAD(place_first, index + 1u)) - params.first_sample;
    }
    if (params.block == CORNERS) {
        vertex = index;
        return uvec2(LOAD(contribution_first, index), LOAD(contribution_first, index + 1u)) - params.first_sample;
    }
    if (params.block == INTERIORS) {
        uint points = interior_points(n);
        uint list = index / points;
        uint interiors = params.lattice.corners + params.lattice.edges * (n - 1u);
        vertex = interiors + LOAD(triangle_order, list) * points + index - list * points;
        return uvec2(index, index + 1u) - params.first_sample;
    }
    vertex = params.lattice.corners + index;
    uint edge = index / (n - 1u);
    uint point = index - edge * (n - 1u);
    uvec2 items = uvec2(LOAD(contribution_first, params.lattice.corners + edge), LOAD(contribution_first, params.lattice.corners + edge + 1u));
    return items * (n - 1u) + point - params.first_sample;
}

void element(uint i) {
    uint vertex;
    uvec2 range = samples_of(i + params.start, vertex);
    uint stride = params.block == EDGES ? (1u << params.lattice.level) - 1u : 1u;
    vec3 sum = vec3(0.0);
    vec3 base = vec3(0.0);
    bool moved = false;
    for (uint at = range.x; at < range.y; at += stride) {
        vec3 shading;
        sum += displaced_normal(at, moved, shading);
        base += shading;
    }
    // A corner's own normal is unit and keeps its bits; the others are blends.
    base = vertex < params.lattice.corners ? normal_of(vertex) : normalize(base);
    float size = length(sum);
    STORE(normals, vertex, moved && size > 1e-6 ? sum / size : base);
}

#include "batch.glsl"
