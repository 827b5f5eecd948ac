#version 460
#extension GL_GOOGLE_include_directive : require
// Where maps are read at the places of fragments that are projected onto them: a thread per fragment makes a point for the
// passes `texture_*` to read, whose corners are (u, v) and its derivatives, each with the weight 1 where it is asked for.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "trigonometry.glsl"
#include "projection.glsl"
#include "projected_frame.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint kind;  // PROJECTION_*
    uint index; // of the projections of a kind
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, vec3, positions);
PAGED(2, readonly, vec3, normals);
// Of each instance the centre of its mesh's box, and its longest side.
PAGED(3, readonly, vec4, boxes);
PAGED(4, writeonly, SurfacePoint, projected_points);
// Three for each fragment.
PAGED(5, writeonly, vec2, projected_uvs);
PAGED(6, writeonly, ProjectedFrame, frames);

ProjectedPlace place_of(SurfacePoint point) {
    vec4 box = LOAD(boxes, point.instance);
    mat3 position;
    mat3 normal;
    for (int k = 0; k < 3; ++k) {
        position[k] = (LOAD(positions, point.vertices[k]) - box.xyz) / box.w;
        normal[k] = LOAD(normals, point.vertices[k]);
    }
    vec3 n = normal * point.at;
    float squared = dot(n, n);
    n = squared > 1e-30 && squared < 1e30 ? n * inversesqrt(squared) : vec3(0.0);
    return ProjectedPlace(position * point.at, position * point.at_dx, position * point.at_dy, n);
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Projected found = projected(params.kind, place_of(point), params.index);
    STORE(projected_uvs, 3u * i, found.uv);
    STORE(projected_uvs, 3u * i + 1u, found.dx);
    STORE(projected_uvs, 3u * i + 2u, found.dy);
    STORE(frames, i, ProjectedFrame(found.tangent, found.weight, found.bitangent));
    point.vertices = 3u * i + uvec3(0u, 1u, 2u);
    point.at = vec3(1.0, 0.0, 0.0);
    point.at_dx = vec3(0.0, 1.0, 0.0);
    point.at_dy = vec3(0.0, 0.0, 1.0);
    STORE(projected_points, i, point);
}

#include "batch.glsl"
