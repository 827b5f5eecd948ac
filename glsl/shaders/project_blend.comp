#version 460
#extension GL_GOOGLE_include_directive : require
// Adds what a map shows of fragments under one projection to what it shows under those before. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "projected_frame.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint index;    // of the projections of a kind
    uint is_slope; // the map is of normals, whose values have no frame in common: what is added is the slope
} params;

PAGED(0, readonly, ProjectedFrame, frames);
PAGED(1, readonly, vec4, seen);
PAGED(2, , vec4, mapped);

// Minus the slope that a normal map describes, in the mesh's space (surface gradients, Mikkelsen 2020).
vec3 tilt_of(ProjectedFrame frame, vec3 value) {
    return (value.x * frame.tangent + value.y * frame.bitangent) / max(value.z, 1.0 / 64.0);
}

void element(uint i) {
    ProjectedFrame frame = LOAD(frames, i);
    vec4 value = LOAD(seen, i);
    if (params.is_slope != 0u) {
        value = vec4(tilt_of(frame, value.xyz), 1.0);
    }
    vec4 before = params.index > 0u ? LOAD(mapped, i) : vec4(0.0);
    STORE(mapped, i, before + frame.weight * value);
}

#include "batch.glsl"
