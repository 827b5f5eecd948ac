#version 460
// Evaluates a smooth base at samples, with derivatives: what the jet passes read of it.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#include "frame.glsl"
#include "sample.glsl"
#include "smooth.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
} params;

PAGED(6, readonly, Sample, samples);
PAGED(7, writeonly, Fields, fields);

void element(uint i) {
    Sample place = LOAD(samples, i);
    if (place.detail == NONE && place.weight.x == 0.0) {
        return;
    }
    Site site = Site(place.av, vec3(1.0 - place.b.x - place.b.y, place.b), place.patch_code);
    STORE(fields, i, fields_at(site));
}

#include "batch.glsl"
