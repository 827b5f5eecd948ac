#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
// Known answer: a dispatch cut into pieces numbers its threads as a whole one does, and subgroups
// partition a workgroup.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint mapped; // threads whose subgroups are looked at
} params;

struct Mapping {
    uint subgroup;
    uint lane;
    uint subgroups;
    uint elected;
};

PAGED(0, writeonly, uint, numbers);
PAGED(1, writeonly, Mapping, mappings);

void main() {
    uint i = thread_index();
    if (i >= params.count) {
        return;
    }
    STORE(numbers, i, i + 1u);
    bool elected = subgroupElect();
    if (i < params.mapped) {
        STORE(mappings, i, Mapping(gl_SubgroupID, gl_SubgroupInvocationID, gl_NumSubgroups, elected ? 1u : 0u));
    }
}
