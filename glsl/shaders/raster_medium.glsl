// Triangles up to 64 pixels wide: a workgroup walks 8 x 8 pixel blocks of its triangle's box.
#include "raster_common.glsl"
PAGED(3, readonly, uvec3, triangles);
PAGED(4, readonly, Part, parts);
PAGED(5, readonly, ivec4, screen);
PAGED(6, readonly, uint, lists);
#include "triangle_32.glsl"

// Whether any point of the block with these corners (relative to the origin) may lie inside.
bool meets_block(Triangle32 t, ivec2 low, ivec2 high) {
    for (int k = 0; k < 3; ++k) {
        ivec2 edge = t.edge[k];
        ivec2 best = ivec2(edge.y < 0 ? high.x : low.x, edge.x > 0 ? high.y : low.y) - t.corner[(k + 1) % 3];
        if (edge.x * best.y - edge.y * best.x < 0) {
            return false;
        }
    }
    return true;
}

void cover_block(uint id, Triangle32 t, ivec2 pixel) {
    for (int s = 0; s < 4; ++s) {
        ivec3 edges = edges_at(t, pixel * 256 + ivec2(sample_x(s), sample_y(s)) - t.origin);
        if (is_inside(edges, t.bias)) {
            cover_sample(id, pixel, s, depth_at(t, edges));
        }
    }
}

void main() {
    uint group = group_index();
    if (group >= params.count) {
        return;
    }
    uint id = LOAD(lists, params.list_first + group);
    Triangle32 t = load_triangle(id);
    ivec2 first = max(t.origin >> 8, params.slab_px);
    ivec2 last = min(t.high >> 8, params.slab_px + params.slab_size_px - 1);
    int lane = int(gl_LocalInvocationID.x);
    // 65 pixels span at most 9 blocks each way.
    ivec2 blocks = min((last - first + 8) >> 3, ivec2(9));
    for (int block = 0; block < blocks.x * blocks.y; ++block) {
        ivec2 corner = first + ivec2(block % blocks.x, block / blocks.x) * 8;
        ivec2 low = corner * 256 - t.origin;
        ivec2 pixel = corner + ivec2(lane & 7, lane >> 3);
        if (meets_block(t, low, low + 8 * 256) && all(lessThanEqual(pixel, last))) {
            cover_block(id, t, pixel);
        }
    }
}
