// Tiles of 16 x 16 pixels, numbered from the slab's top left.
// Needs Triangle64, params.slab_px, params.slab_size_px and coverage.glsl in scope.

const int TILE_PX = 16;

// First and last tile (x, y, x, y) that the triangle's box may hold a sample of; empty when
// last < first.
ivec4 tiles_of(Triangle64 t) {
    ivec2 low = min(min(t.corner[0], t.corner[1]), t.corner[2]);
    ivec2 high = max(max(t.corner[0], t.corner[1]), t.corner[2]);
    ivec2 first_px = ivec2(first_pixel(low.x, 224), first_row(low.y) >> 2);
    ivec2 last_px = ivec2(last_pixel(high.x, 32), last_row(high.y) >> 2);
    first_px = max(first_px - params.slab_px, ivec2(0));
    last_px = min(last_px - params.slab_px, params.slab_size_px - 1);
    if (any(lessThan(last_px, first_px))) {
        return ivec4(0, 0, -1, -1);
    }
    return ivec4(first_px / TILE_PX, last_px / TILE_PX);
}
