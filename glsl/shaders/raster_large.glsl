// (record, tile) pairs: a workgroup covers one tile of one triangle, in 64-bit integers throughout.
#include "raster_common.glsl"
PAGED(3, readonly, ivec4, records);
PAGED(4, readonly, uvec2, pairs);
#include "triangle_64.glsl"

const int TILE_PX = 16;
const uint NO_RECORD = 0xFFFFFFFFu;

float depth_at(Triangle64 t, vec2 slope, int64_t edge_1, int64_t edge_2) {
    precise float depth = t.depth.x + (float(edge_1) * slope.x + float(edge_2) * slope.y);
    float low = min(min(t.depth.x, t.depth.y), t.depth.z);
    float high = max(max(t.depth.x, t.depth.y), t.depth.z);
    return clamp(depth, low, high);
}

void cover_pixel(Triangle64 t, vec2 slope, ivec2 pixel) {
    int64_t edges[3];
    for (int k = 0; k < 3; ++k) {
        edges[k] = edge_at(t, k, pixel * 256);
    }
    for (int s = 0; s < 4; ++s) {
        int64_t at[3];
        int64_t outside = 0l;
        for (int k = 0; k < 3; ++k) {
            at[k] = edges[k] + int64_t(t.edge[k].x) * sample_y(s) - int64_t(t.edge[k].y) * sample_x(s);
            outside |= at[k] + edge_bias(t.edge[k]);
        }
        if (outside >= 0l) {
            cover_sample(t.id, pixel, s, depth_at(t, slope, at[1], at[2]));
        }
    }
}

void main() {
    uint group = group_index();
    if (group >= params.count) {
        return;
    }
    uvec2 pair = LOAD(pairs, params.list_first + group);
    if (pair.x == NO_RECORD) {
        return;
    }
    Triangle64 t = load_record(pair.x);
    vec2 slope = (t.depth.yz - t.depth.x) / float(edge_at(t, 0, t.corner[0]));
    ivec2 first = ivec2(pair.y & 0xFFFFu, pair.y >> 16) * TILE_PX + params.slab_px;
    ivec2 end = min(first + TILE_PX, params.slab_px + params.slab_size_px);
    int lane = int(gl_LocalInvocationID.x);
    for (int block = 0; block < 4; ++block) {
        ivec2 pixel = first + ivec2((block & 1) * 8 + (lane & 7), (block >> 1) * 8 + (lane >> 3));
        if (all(lessThan(pixel, end))) {
            cover_pixel(t, slope, pixel);
        }
    }
}
