#version 460
#extension GL_GOOGLE_include_directive : require
// Lists what is to be shaded: a thread per pixel makes one fragment for each distinct triangle of its four samples, at the
// centroid of the samples it covers; of relief one for each sample, for what they strike may lie far apart. The fragments of a
// pixel are neighbours, in the order of their first samples; where in the list they begin varies between runs and changes
// nothing.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "coverage.glsl"
#include "fragment.glsl"
#include "visibility_key.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // pixels
    ivec2 slab_px;
    ivec2 slab_size_px;
    uint part_last;
    uint has_relief; // 0: no part is asked whether it is relief
} params;

PAGED(0, readonly, uint64_t, visibility);
PAGED(1, , uint, fragment_count);
PAGED(2, writeonly, Fragment, fragments);
// First fragment and, in the low three bits, their number.
PAGED(3, writeonly, uint, pixels);
PAGED(4, readonly, Part, parts);

bool is_relief(uint id) {
    if (params.has_relief == 0u) {
        return false;
    }
    FIND_PART(id, 0u, params.part_last, part)
    return (part.flags & PART_RELIEF) != 0u;
}

void element(uint i) {
    uint width = uint(params.slab_size_px.x);
    vec2 pixel = vec2(params.slab_px + ivec2(i % width, i / width));
    uint ids[4];
    for (int s = 0; s < 4; ++s) {
        ids[s] = id_of(LOAD(visibility, i * 4u + uint(s)));
    }
    Fragment found[4];
    uint n = 0u;
    for (int first = 0; first < 4; ++first) {
        bool alone = ids[first] != NOTHING && is_relief(ids[first]);
        bool known = ids[first] == NOTHING;
        uint covered = 0u;
        ivec2 sum = ivec2(0);
        for (int s = 0; s < 4; ++s) {
            bool same = ids[s] == ids[first] && (s == first || !alone);
            known = known || (same && s < first);
            covered |= same ? 1u << s : 0u;
            sum += same ? ivec2(sample_x(s), sample_y(s)) : ivec2(0);
        }
        if (!known) {
            found[n++] = Fragment(ids[first], pixel + vec2(sum) / float(256 * bitCount(covered)), covered);
        }
    }
    uint place = n > 0u ? atomicAdd(ELEMENT(fragment_count, 0u), n) : 0u;
    STORE(pixels, i, place << 3 | n);
    for (uint k = 0u; k < n; ++k) {
        STORE(fragments, place + k, found[k]);
    }
}

#include "batch.glsl"
