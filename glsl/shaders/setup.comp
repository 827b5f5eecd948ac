#version 460
#extension GL_GOOGLE_include_directive : require
// Drops what cannot be seen in the slab and sorts the rest by size: a thread per triangle.
// The lists' order varies between runs; the visibility key makes the image independent of it.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "snap.glsl"
#include "coverage.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first_triangle;
    uint part_first;
    uint part_last;
    ivec2 slab_px;      // top left
    ivec2 slab_size_px;
    uint capacity;
    uint blended; // sort what is blended, and nothing else; 0: all else
} params;

PAGED(0, readonly, uvec3, triangles);
PAGED(1, readonly, Part, parts);
PAGED(2, readonly, ivec4, screen);
// Lengths of the lists.
PAGED(3, , uint, counters);
// LISTS lists of triangle ids, each with room for params.capacity.
PAGED(4, writeonly, uint, lists);

const uint DROPPED = 0xFFFFFFFFu;
const uint SMALL = 0u;
const uint MEDIUM = 1u;
const uint LARGE = 2u;
// Materials with an alpha cut-off have two classes of their own, small and everything else.
const uint SMALL_MASKED = 3u;
const uint LARGE_MASKED = 4u;
const uint LISTS = 5u;
// Widest boxes of the first two classes, fixed point. Within MEDIUM_BOX edge functions fit 32 bits.
const int SMALL_BOX = 4 * SUBPIXELS;
const int MEDIUM_BOX = 64 * SUBPIXELS;

// Whether the box holds a sample; exact for boxes lower than a pixel, where it matters most.
bool holds_sample(ivec2 low, ivec2 high, int row_first, int row_last) {
    if (row_last - row_first > 2) {
        return true;
    }
    [[dont_unroll]] for (int row = row_first; row <= row_last; ++row) {
        int x = sample_x(row & 3);
        if (first_pixel(low.x, x) <= last_pixel(high.x, x)) {
            return true;
        }
    }
    return false;
}

bool meets_slab(ivec2 low, ivec2 high) {
    ivec2 slab_low = params.slab_px * SUBPIXELS;
    ivec2 slab_high = (params.slab_px + params.slab_size_px) * SUBPIXELS;
    return all(lessThan(low, slab_high)) && all(greaterThanEqual(high, slab_low));
}

bool faces_away(ivec2 a, ivec2 b, ivec2 c, uint part_flags) {
    int64_t area = int64_t(b.x - a.x) * int64_t(c.y - a.y) - int64_t(b.y - a.y) * int64_t(c.x - a.x);
    bool front = (area < 0l) != ((part_flags & PART_MIRRORED) != 0u);
    return area == 0l || (!front && (part_flags & PART_DOUBLE_SIDED) == 0u);
}

uint classify(uint id) {
    FIND_PART(id, params.part_first, params.part_last, part)
    if (((part.flags & PART_BLENDED) != 0u) != (params.blended != 0u) || (part.flags & PART_UNSEEN) != 0u) {
        return DROPPED;
    }
    uvec3 v = LOAD(triangles, part.triangle_base + (id - part.first_triangle)) + part.screen_base;
    ivec4 a = LOAD(screen, v.x);
    ivec4 b = LOAD(screen, v.y);
    ivec4 c = LOAD(screen, v.z);
    uint all_flags = uint(a.w & b.w & c.w);
    uint any_flags = uint(a.w | b.w | c.w);
    if ((all_flags & OUTSIDE_ANY) != 0u || (any_flags & NOT_FINITE) != 0u) {
        return DROPPED;
    }
    bool masked = (part.flags & PART_MASKED) != 0u;
    if ((any_flags & NEEDS_CLIP) != 0u) {
        return masked ? LARGE_MASKED : LARGE;
    }
    ivec2 low = min(min(a.xy, b.xy), c.xy);
    ivec2 high = max(max(a.xy, b.xy), c.xy);
    int row_first = first_row(low.y);
    int row_last = last_row(high.y);
    if (!meets_slab(low, high) || !holds_sample(low, high, row_first, row_last)) {
        return DROPPED;
    }
    if (faces_away(a.xy, b.xy, c.xy, part.flags)) {
        return DROPPED;
    }
    int box = max(high.x - low.x, high.y - low.y);
    if (masked) {
        return box <= SMALL_BOX ? SMALL_MASKED : LARGE_MASKED;
    }
    return box <= SMALL_BOX ? SMALL : box <= MEDIUM_BOX ? MEDIUM : LARGE;
}

// Reserves a place in list `which` for every invocation that is active here: one atomic per subgroup.
uint reserve(uint which) {
    uvec4 active_lanes = subgroupBallot(true);
    uint first = 0u;
    if (subgroupElect()) {
        first = atomicAdd(ELEMENT(counters, which), subgroupBallotBitCount(active_lanes));
    }
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(active_lanes);
}

void element(uint i) {
    uint id = params.first_triangle + i;
    uint size_class = classify(id);
    // One pass over the lists, so that the lanes that append to one do it together.
    [[dont_unroll]] for (uint list = 0u; list < LISTS; ++list) {
        if (size_class == list) {
            uint place = reserve(list);
            STORE(lists, list * params.capacity + place, id);
        }
    }
}

#include "batch.glsl"
