#version 460
#extension GL_GOOGLE_include_directive : require
// Large triangles become records in fixed point; those that cross the near or far plane or the guard band
// are clipped first and leave up to seven records, which keep the triangle's id. A thread per triangle.
//
// A cut edge is always cut from its inner end, so both triangles of an edge find the same point.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "snap.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint list_first; // in lists
    uint part_first;
    uint part_last;
} params;

PAGED(0, readonly, uvec3, triangles);
PAGED(1, readonly, Part, parts);
PAGED(2, readonly, ivec4, screen);
PAGED(3, readonly, uint, lists);
PAGED(4, readonly, vec3, positions);
PAGED(5, readonly, vec4, instance_rows);
// Three per record: x, y, depth bits, triangle id; clockwise. Empty records have NO_TRIANGLE there.
PAGED(6, writeonly, ivec4, records);

const int NO_TRIANGLE = -1;
const int MAX_PIECES = 7;
// A triangle cut by six planes has at most nine corners.
const int MAX_CORNERS = 9;

vec4 polygon[MAX_CORNERS];
// The polygon in fixed point: x, y, depth bits.
ivec3 outline[MAX_CORNERS];
int corners;

#include "project.glsl"

// Signed distance to plane k, positive inside: near, far, and the four sides of the guard band.
float distance_to(int k, vec4 h) {
    if (k < 2) {
        return k == 0 ? h.w - h.z : h.z;
    }
    float side = k < 4 ? h.x : h.y;
    precise float distance = GUARD_PX * h.w + ((k & 1) == 0 ? side : -side);
    return distance;
}

vec4 cut(vec4 inner, vec4 outer, float inner_distance, float outer_distance) {
    precise float t = inner_distance / (inner_distance - outer_distance);
    precise vec4 point = inner + (outer - inner) * t;
    return point;
}

// Sutherland-Hodgman against one plane.
void cut_polygon(int plane) {
    vec4 kept[MAX_CORNERS];
    int n = 0;
    [[dont_unroll]] for (int i = 0; i < corners; ++i) {
        vec4 a = polygon[i];
        vec4 b = polygon[i + 1 == corners ? 0 : i + 1];
        float da = distance_to(plane, a);
        float db = distance_to(plane, b);
        if (da >= 0.0 && n < MAX_CORNERS) {
            kept[n++] = a;
        }
        if (da >= 0.0 != db >= 0.0 && n < MAX_CORNERS) {
            kept[n++] = da >= 0.0 ? cut(a, b, da, db) : cut(b, a, db, da);
        }
    }
    corners = n;
    [[dont_unroll]] for (int i = 0; i < n; ++i) {
        polygon[i] = kept[i];
    }
}

// Whether the piece faces away or has no area; `area` is positive when it runs clockwise.
bool is_hidden(int64_t area, uint part_flags) {
    bool front = (area < 0l) != ((part_flags & PART_MIRRORED) != 0u);
    return area == 0l || (!front && (part_flags & PART_DOUBLE_SIDED) == 0u);
}

void write_record(uint place, uint id, uint part_flags, ivec3 a, ivec3 b, ivec3 c) {
    int64_t area = int64_t(b.x - a.x) * int64_t(c.y - a.y) - int64_t(b.y - a.y) * int64_t(c.x - a.x);
    int tag = is_hidden(area, part_flags) ? NO_TRIANGLE : int(id);
    STORE(records, place, ivec4(a, tag));
    STORE(records, place + 1u, ivec4(area < 0l ? c : b, tag));
    STORE(records, place + 2u, ivec4(area < 0l ? b : c, tag));
}

// Loads the triangle as a polygon in homogeneous pixels, cuts it by all planes and snaps what is left.
void clip_polygon(uint instance, uvec3 v) {
    [[dont_unroll]] for (int k = 0; k < 3; ++k) {
        polygon[k] = homogeneous(instance, LOAD(positions, v[k]));
    }
    [[dont_unroll]] for (int plane = 0; plane < 6; ++plane) {
        cut_polygon(plane);
    }
    [[dont_unroll]] for (int k = 0; k < corners; ++k) {
        outline[k] = snapped(polygon[k]);
    }
}

void element(uint i) {
    uint id = LOAD(lists, params.list_first + i);
    FIND_PART(id, params.part_first, params.part_last, part)
    uvec3 v = LOAD(triangles, part.triangle_base + (id - part.first_triangle));
    int flags = 0;
    [[dont_unroll]] for (int k = 0; k < 3; ++k) {
        ivec4 vertex = LOAD(screen, v[k] + part.screen_base);
        outline[k] = vertex.xyz;
        flags |= vertex.w;
    }
    corners = 3;
    if ((uint(flags) & NEEDS_CLIP) != 0u) {
        clip_polygon(part.instance, v);
    }
    [[dont_unroll]] for (int piece = 0; piece < MAX_PIECES; ++piece) {
        uint place = (i * uint(MAX_PIECES) + uint(piece)) * 3u;
        if (piece + 2 < corners) {
            write_record(place, id, part.flags, outline[0], outline[piece + 1], outline[piece + 2]);
        } else {
            STORE(records, place, ivec4(NO_TRIANGLE));
        }
    }
}

#include "batch.glsl"
