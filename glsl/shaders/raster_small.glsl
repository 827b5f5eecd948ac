// Triangles of a few pixels: a thread walks the samples of its triangle's box row by row.
#include "raster_common.glsl"
PAGED(3, readonly, uvec3, triangles);
PAGED(4, readonly, Part, parts);
PAGED(5, readonly, ivec4, screen);
PAGED(6, readonly, uint, lists);
#include "triangle_32.glsl"

// SMALL_BOX of setup is 4 pixels: at most 17 sample rows of 5 pixels.
const int MAX_ROWS = 17;
const int MAX_PIXELS = 5;

void element(uint i) {
    uint id = LOAD(lists, params.list_first + i);
    Triangle32 t = load_triangle(id);
    ivec2 slab_end = params.slab_px + params.slab_size_px;
    int row = max(first_row(t.origin.y), params.slab_px.y * 4);
    int row_end = min(min(last_row(t.high.y) + 1, slab_end.y * 4), row + MAX_ROWS);
    ivec3 step_x = ivec3(t.edge[0].y, t.edge[1].y, t.edge[2].y) * -256;
    for (; row < row_end; ++row) {
        int s = row & 3;
        int x = sample_x(s);
        int pixel = max(first_pixel(t.origin.x, x), params.slab_px.x);
        int pixel_end = min(min(last_pixel(t.high.x, x) + 1, slab_end.x), pixel + MAX_PIXELS);
        ivec3 edges = edges_at(t, ivec2(pixel * 256 + x, row * 64 + 32) - t.origin);
        for (; pixel < pixel_end; ++pixel) {
            if (is_inside(edges, t.bias)) {
                cover_sample(id, ivec2(pixel, row >> 2), s, depth_at(t, edges));
            }
            edges += step_x;
        }
    }
}

#include "batch.glsl"
