#version 460
// One displacement for each geometric vertex that has several attribute vertices: the mean of their
// distinct candidates, or the dominant one. Writes the position to all, and what each is off by.
#include "common.glsl"
#include "pages.glsl"
#include "seams.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint start;        // number of the first thread's seam
    uint first_sample; // number of the first jet
    uint rule;
} params;

PAGED(0, readonly, vec4, av_position_u);
PAGED(1, readonly, Seam, seam_vertices);
PAGED(2, readonly, SeamSide, seam_corners);
PAGED(3, readonly, mat3, jets); // of seam_corners
PAGED(4, writeonly, vec3, av_correction);
PAGED(5, writeonly, vec3, positions);
PAGED(6, , uint, counters);

const uint MISMATCH = 2u;

// Sides that every side is compared with: all of them where few meet.
const uint COMPARED = 32u;

vec3 candidate(const uint at) {
    return LOAD(jets, at - params.first_sample)[0];
}

bool is_distinct(const Seam seam, const uint rank) {
    return LOAD(seam_corners, seam.first + rank).same_as == rank;
}

// Largest distance between two candidates; where more than COMPARED sides meet, at least half of it.
float mismatch(const Seam seam) {
    float worst = 0.0;
    for (uint a = 1u; a < seam.count; ++a) {
        for (uint b = 0u; b < (is_distinct(seam, a) ? min(a, COMPARED) : 0u); ++b) {
            float apart = length(candidate(seam.first + a) - candidate(seam.first + b));
            worst = max(worst, is_distinct(seam, b) ? apart : 0.0);
        }
    }
    return worst;
}

void element(uint i) {
    Seam seam = LOAD(seam_vertices, i + params.start);
    vec3 displacement = vec3(0.0);
    for (uint rank = 0u; rank < seam.count; ++rank) {
        vec3 part = candidate(seam.first + rank) * share(seam, params.rule, rank);
        precise vec3 sum = displacement + (is_distinct(seam, rank) ? part : vec3(0.0));
        displacement = sum;
    }
    precise vec3 position = LOAD(av_position_u, LOAD(seam_corners, seam.first).id).xyz + displacement;
    for (uint rank = 0u; rank < seam.count; ++rank) {
        SeamSide corner = LOAD(seam_corners, seam.first + rank);
        STORE(av_correction, corner.id, displacement - candidate(seam.first + corner.same_as));
        STORE(positions, corner.id, position);
    }
    atomicMax(ELEMENT(counters, MISMATCH), floatBitsToUint(mismatch(seam)));
}

#include "batch.glsl"
