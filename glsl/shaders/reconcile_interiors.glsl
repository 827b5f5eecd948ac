// Positions inside the base triangles that touch seams, from their corrected jets.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#ifdef SMOOTH
#include "fields.glsl"

PAGED(13, readonly, Fields, fields); // of the samples
#endif
#include "sample.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint start; // number of the first sample: list * points + rank
    Lattice lattice;
} params;

PAGED(6, readonly, uint, triangle_order);
PAGED(7, readonly, Sample, samples);
PAGED(8, readonly, mat3, jets);
PAGED(9, writeonly, vec3, positions);

void element(uint i) {
    uint n = 1u << params.lattice.level;
    uint points = interior_points(n);
    uint list = (i + params.start) / points;
    uint rank = i + params.start - list * points;
    uint vertex = params.lattice.corners + params.lattice.edges * (n - 1u) + LOAD(triangle_order, list) * points + rank;
    Sample place = LOAD(samples, i);
    vec3 b = vec3(1.0 - place.b.x - place.b.y, place.b);
#ifdef SMOOTH
    vec3 base = LOAD(fields, i).position[0];
#else
    vec3 base = blend(b, position_u(place.av.x).xyz, position_u(place.av.y).xyz, position_u(place.av.z).xyz);
#endif
    precise vec3 position = base + LOAD(jets, i)[0];
    STORE(positions, vertex, position);
}

#include "batch.glsl"
