#version 460
// Adds the corner corrections of seams, hat functions over the base triangles, to the jets of samples.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#include "frame.glsl"
#include "sample.glsl"
#include "jets.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
} params;

PAGED(8, readonly, vec3, av_correction);

void element(uint i) {
    Sample place = LOAD(samples, i);
    if (place.detail == NONE) {
        return;
    }
    Site site = site_of_sample(place);
    mat3 hats = jet(site.b, LOAD(av_correction, site.av.x), LOAD(av_correction, site.av.y), LOAD(av_correction, site.av.z));
    add_jet(i, place, hats, true);
}

#include "batch.glsl"
