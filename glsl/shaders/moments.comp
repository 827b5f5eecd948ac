#version 460
#extension GL_GOOGLE_include_directive : require
// How the normals under each fragment scatter: the covariance of slopes of a map (LEAN, Olano and Baker 2010) from their
// filtered means and second moments, in the plane across the fragment's normal. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "raster_tables.glsl"
#include "material.glsl"
#include "texture_use.glsl"
#include "texture_footprint.glsl"
#include "spread.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint uv_channels; // of each vertex
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Material, materials);
PAGED(2, readonly, vec4, tangents);
PAGED(3, readonly, vec4, instance_rows);
PAGED(4, readonly, TextureUse, maps);
PAGED(5, readonly, vec2, uvs);
PAGED(6, readonly, uvec4, levels);
PAGED(7, readonly, vec4, mapped_normal);         // slopes along x and y, 1, 1
PAGED(8, readonly, vec4, mapped_normal_moments); // xx, yy and xy of slopes, 1
PAGED(9, writeonly, Spread, spreads);
#include "mapped_direction.glsl"

// xx, xy and yy. Never negative, though rounding may leave a difference of near equals so.
vec3 covariance(vec2 mean, vec3 moments) {
    float xx = max(moments.x - mean.x * mean.x, 0.0);
    float yy = max(moments.y - mean.y * mean.y, 0.0);
    float most = sqrt(xx * yy);
    return vec3(xx, clamp(moments.z - mean.x * mean.y, -most, most), yy);
}

// Share of the spread that a pixel sees. Within a texel there is none: what is bilinear between texels has the slopes that it
// shows there, and the products are those of whole texels. A pixel of two texels sees all.
float covered(SurfacePoint point, TextureUse map) {
    mat3x2 corner;
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(uvs, point.vertices[k] * params.uv_channels + map.uv_channel);
    }
    mat2x3 rows = mat2x3(map.map_u, map.map_v);
    vec2 dx = vec3(corner * point.at_dx, 0.0) * rows;
    vec2 dy = vec3(corner * point.at_dy, 0.0) * rows;
    float texels = footprint_of(vec2(LOAD(levels, map.level_first).yz), dx, dy).major;
    return finite(texels) ? clamp((texels * texels - 1.0) / 3.0, 0.0, 1.0) : 1.0;
}

// From slopes along the axes of the tangent frame to those over the plane across the mean normal, to first order.
vec3 across_normal(mat2x3 frame, vec3 e, vec3 f, float size, vec3 sigma) {
    float a = dot(frame[0], e) / size;
    vec2 b = vec2(dot(frame[1], e), dot(frame[1], f)) / size;
    return vec3(
        a * a * sigma.x + 2.0 * a * b.x * sigma.y + b.x * b.x * sigma.z,
        a * b.y * sigma.y + b.x * b.y * sigma.z,
        b.y * b.y * sigma.z);
}

Spread principal(vec3 e, vec3 f, vec3 sigma) {
    float halved = 0.5 * (sigma.x - sigma.z);
    float root = length(vec2(halved, sigma.y));
    float mean = 0.5 * (sigma.x + sigma.z);
    vec2 along = along_major(halved, sigma.y, root);
    vec2 deviation = sqrt(max(vec2(mean + root, mean - root), 0.0));
    return Spread(deviation.x * (along.x * e + along.y * f), deviation.y * (along.x * f - along.y * e));
}

Spread in_world(SurfacePoint point, vec2 mean, vec3 sigma) {
    mat2x3 frame = tangent_frame(point);
    vec3 n = frame * mean + point.normal * point.flip;
    float size = length(n);
    n /= max(size, 1e-20);
    vec3 e = frame[0] - dot(frame[0], n) * n;
    float across = dot(e, e);
    if (size < 1e-10 || across < 1e-12) {
        return Spread(vec3(0.0), vec3(0.0));
    }
    e *= inversesqrt(across);
    vec3 f = cross(n, e);
    return principal(e, f, across_normal(frame, e, f, size, sigma));
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    TextureUse map = LOAD(maps, point.material * MAP_SLOTS + MAP_NORMAL_MOMENTS);
    if (map.level_count == 0u) {
        STORE(spreads, i, Spread(vec3(0.0), vec3(0.0)));
        return;
    }
    float scale = LOAD(materials, point.material).normal_scale;
    vec2 mean = LOAD(mapped_normal, i).xy;
    vec3 sigma = covariance(mean, LOAD(mapped_normal_moments, i).xyz) * (scale * scale * covered(point, map));
    STORE(spreads, i, in_world(point, scale * mean, sigma));
}

#include "batch.glsl"
