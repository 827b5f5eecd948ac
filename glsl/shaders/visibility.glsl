// The visibility buffer: one 64-bit key per sample of the slab. The largest wins: the nearest triangle, and of
// equal depths the smallest id, whatever the order of execution.
// Needs `visibility` and params.slab_px, params.slab_size_px in scope.
#include "visibility_key.glsl"

uint sample_place(ivec2 pixel, int s) {
    ivec2 place = pixel - params.slab_px;
    return uint((place.y * params.slab_size_px.x + place.x) * 4 + s);
}

// The upper half only grows, so a stale or torn value can only let a needless write through.
bool may_be_visible(uint place, uint depth_bits) {
    return uint(ELEMENT(visibility, place) >> 32) <= depth_bits;
}

void write_visibility(uint id, uint place, uint depth_bits) {
    if (may_be_visible(place, depth_bits)) {
        atomicMax(ELEMENT(visibility, place), key_of(id, depth_bits));
    }
}
