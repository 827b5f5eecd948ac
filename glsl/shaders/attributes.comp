#version 460
// Interpolates one attribute stream of `components` floats over fine vertices.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint start; // number of the first thread's vertex in its block
    uint to;    // its number in `values`
    uint block;
    uint components;
    Lattice lattice;
} params;

PAGED(4, readonly, BaseEdge, base_edges);
PAGED(5, readonly, BaseTriangle, base_triangles);
PAGED(6, readonly, float, base_values);
PAGED(7, writeonly, float, values);

#include "site.glsl"

void element(uint i) {
    Site site = site_of(params.lattice, params.block, i + params.start);
    uvec3 from = site.av * params.components;
    uint to = (i + params.to) * params.components;
    for (uint k = 0u; k < params.components; ++k) {
        precise float value = site.b.x * LOAD(base_values, from.x + k) + site.b.y * LOAD(base_values, from.y + k) + site.b.z * LOAD(base_values, from.z + k);
        STORE(values, to + k, value);
    }
}

#include "batch.glsl"
