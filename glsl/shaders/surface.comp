#version 460
#extension GL_GOOGLE_include_directive : require
// What lies under each fragment: perspective-correct weights of the vertices and their derivatives, position and
// normals. Of a triangle that is drawn in place of another, what lies under that other one's plane. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint part_last;
} params;

PAGED(0, readonly, Fragment, fragments);
PAGED(1, readonly, uvec3, triangles);
PAGED(2, readonly, Part, parts);
PAGED(3, readonly, vec4, instance_rows);
PAGED(4, readonly, vec3, positions);
PAGED(5, readonly, vec3, normals);
PAGED(6, writeonly, SurfacePoint, points);

struct Barycentrics {
    vec3 at;
    vec3 dx; // per pixel
    vec3 dy;
    bool clockwise; // on the screen
};

// Olano and Greer 1997: right even when a corner is behind the camera. The columns of `corner` hold
// homogeneous (x, y, w) of the corners, moved so that the point asked for is the origin.
Barycentrics barycentrics_of(mat3 corner) {
    vec3 c0 = cross(corner[1], corner[2]);
    vec3 c1 = cross(corner[2], corner[0]);
    vec3 c2 = cross(corner[0], corner[1]);
    mat3 rows = transpose(mat3(c0, c1, c2));
    float sum = rows[2].x + rows[2].y + rows[2].z;
    Barycentrics b;
    b.clockwise = sum > 0.0;
    vec3 at = rows[2] / sum;
    b.dx = (rows[0] - at * (rows[0].x + rows[0].y + rows[0].z)) / sum;
    b.dy = (rows[1] - at * (rows[1].x + rows[1].y + rows[1].z)) / sum;
    // Snapping to fixed point can put a sample just outside: what is seen there is the triangle's rim.
    at = max(at, vec3(0.0));
    float total = at.x + at.y + at.z;
    b.at = total > 0.0 && total < 1e30 ? at / total : vec3(1.0 / 3.0);
    return b;
}

Barycentrics barycentrics_at(uint row, mat3 position, vec2 at_px) {
    vec4 w = LOAD(instance_rows, row + 3u);
    vec4 x = LOAD(instance_rows, row) - at_px.x * w;
    vec4 y = LOAD(instance_rows, row + 1u) - at_px.y * w;
    mat4x3 homogeneous = transpose(mat3x4(x, y, w));
    mat3 corner;
    for (int k = 0; k < 3; ++k) {
        corner[k] = homogeneous * vec4(position[k], 1.0);
    }
    return barycentrics_of(corner);
}

#include "world.glsl"

// Unit normal of the triangle's front in the world.
vec3 front_of(uint row, mat3 position) {
    vec3 across = cross(position[1] - position[0], position[2] - position[0]);
    float largest = max(max(abs(across.x), abs(across.y)), abs(across.z));
    return unit_or_zero(mapped(row + NORMAL_ROW, vec4(largest > 0.0 ? across / largest : across, 0.0)));
}

void element(uint i) {
    Fragment fragment = LOAD(fragments, i);
    FIND_PART(fragment.id, 0u, params.part_last, part)
    uint id = part.stands_for + (fragment.id - part.first_triangle) / part.faces;
    if (id != fragment.id) {
        FIND_PART(id, 0u, params.part_last, seen)
        part = seen;
    }
    uint triangle = part.triangle_base + (id - part.first_triangle);
    uvec3 v = LOAD(triangles, triangle);
    mat3 position;
    mat3 normal;
    for (int k = 0; k < 3; ++k) {
        position[k] = LOAD(positions, v[k]);
        normal[k] = LOAD(normals, v[k]);
    }
    uint row = part.instance * INSTANCE_ROWS;
    Barycentrics b = barycentrics_at(row, position, fragment.at_px);
    float flip = b.clockwise != ((part.flags & PART_MIRRORED) != 0u) ? -1.0 : 1.0;
    vec3 n = flip * unit_or_zero(mapped(row + NORMAL_ROW, vec4(normal * b.at, 0.0)));
    vec3 place = mapped(row + WORLD_ROW, vec4(position * b.at, 1.0));
    STORE(points, i, SurfacePoint(
        id, part.material, fragment.extra, part.instance, triangle, v, b.at, b.dx, b.dy, place, n,
        flip * front_of(row, position), flip, uint(fragment.at_px.x) | uint(fragment.at_px.y) << 16));
}

#include "batch.glsl"
