#version 460
// Adds up what marches took in each pixel: a thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "relief.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    ivec2 slab_px;
    ivec2 slab_size_px;
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Course, courses);
PAGED(2, readonly, March, marches);
PAGED(3, , uvec4, costs); // of each pixel: fetches, steps, marches that their bound ended, marches

void element(uint i) {
    if (LOAD(courses, i).nodes < 2u) {
        return;
    }
    March march = LOAD(marches, i);
    uint pixel = LOAD(points, i).pixel;
    ivec2 place = ivec2(pixel & 0xFFFFu, pixel >> 16) - params.slab_px;
    uint at = uint(place.y * params.slab_size_px.x + place.x);
    atomicAdd(ELEMENT(costs, at).x, march.fetches);
    atomicAdd(ELEMENT(costs, at).y, march.steps);
    atomicAdd(ELEMENT(costs, at).z, march.capped);
    atomicAdd(ELEMENT(costs, at).w, 1u);
}

#include "batch.glsl"
