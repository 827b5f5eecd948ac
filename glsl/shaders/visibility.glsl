// The visibility buffer: one 64-bit key per sample of the slab. The largest wins: the nearest triangle, and of
// equal depths the smallest id, whatever the order of execution. With WORDS defined, for devices whose atomics have 32 bits,
// its halves are written one after the other: depths by all triangles first, then the ids of those that are as near.
// Declares `visibility`, binding 0. Needs params.slab_px, params.slab_size_px in scope, with WORDS params.stage.
#include "visibility_key.glsl"

uint sample_place(ivec2 pixel, int s) {
    ivec2 place = pixel - params.slab_px;
    return uint((place.y * params.slab_size_px.x + place.x) * 4 + s);
}

#ifdef WORDS
// Mirrors no struct of the host: the two halves of a key as they lie in memory.
struct VisibilityWords {
    uint low;
    uint high;
};
PAGED(0, , VisibilityWords, visibility);

const uint STAGE_DEPTHS = 0u;

bool may_be_visible(uint place, uint depth_bits) {
    return ELEMENT(visibility, place).high <= depth_bits;
}

void write_visibility(uint id, uint place, uint depth_bits) {
    if (params.stage == STAGE_DEPTHS) {
        atomicMax(ELEMENT(visibility, place).high, depth_bits);
    } else if (ELEMENT(visibility, place).high == depth_bits) {
        atomicMax(ELEMENT(visibility, place).low, 0xFFFFFFFFu - id);
    }
}
#else
PAGED(0, , uint64_t, visibility);

// The upper half only grows, so a stale or torn value can only let a needless write through.
bool may_be_visible(uint place, uint depth_bits) {
    return uint(ELEMENT(visibility, place) >> 32) <= depth_bits;
}

void write_visibility(uint id, uint place, uint depth_bits) {
    if (may_be_visible(place, depth_bits)) {
        atomicMax(ELEMENT(visibility, place), key_of(id, depth_bits));
    }
}
#endif
