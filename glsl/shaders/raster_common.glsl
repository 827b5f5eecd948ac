// What the passes that cover samples share: parameters, streams, and what happens to a covered sample. It
// goes to the visibility buffer; with MASKED defined it becomes a fragment, whose alpha later passes test; with
// PEELED defined it goes there only from between the layer before and what is solid; with COUNTED defined it is counted
// for its pixel, whatever is before it.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#ifndef WORDS
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "coverage.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform RasterParams {
    uint count;
    uint list_first; // in lists or pairs
    uint part_first;
    uint part_last;
    ivec2 slab_px;
    ivec2 slab_size_px;
    uint stage; // of keys that are written by halves
    uint all_depths; // whether samples are kept that what is known hides: where relief decides how far away they are
} params;

#ifdef COUNTED
PAGED(0, , uint, overdraw);

void cover_sample(uint id, ivec2 pixel, int s, float depth) {
    ivec2 place = pixel - params.slab_px;
    atomicAdd(ELEMENT(overdraw, uint(place.y * params.slab_size_px.x + place.x)), 1u);
}
#else
#include "visibility.glsl"
#endif

#ifdef MASKED
#include "fragment.glsl"
PAGED(1, , uint, fragment_count);
PAGED(2, writeonly, Fragment, fragments);

void cover_sample(uint id, ivec2 pixel, int s, float depth) {
    if (params.all_depths == 0u && !may_be_visible(sample_place(pixel, s), floatBitsToUint(depth))) {
        return;
    }
    uint place = atomicAdd(ELEMENT(fragment_count, 0u), 1u);
    vec2 at_px = vec2(pixel) + vec2(float(sample_x(s)), float(sample_y(s))) / 256.0;
    STORE(fragments, place, Fragment(id, at_px, floatBitsToUint(depth)));
}
#elif defined(PEELED)
// Keys of what is solid, and of the layer before this one.
PAGED(1, readonly, uint64_t, solid);
PAGED(2, readonly, uint64_t, nearer);

void cover_sample(uint id, ivec2 pixel, int s, float depth) {
    uint place = sample_place(pixel, s);
    uint64_t key = key_of(id, floatBitsToUint(depth));
    if (key > LOAD(solid, place) && key < LOAD(nearer, place)) {
        write_visibility(id, place, floatBitsToUint(depth));
    }
}
#elif !defined(COUNTED)
void cover_sample(uint id, ivec2 pixel, int s, float depth) {
    write_visibility(id, sample_place(pixel, s), floatBitsToUint(depth));
}
#endif

uint group_index() {
    return gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
}
