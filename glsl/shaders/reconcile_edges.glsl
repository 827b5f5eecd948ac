// One displacement for each fine vertex on a seam, from its sides' candidates. Also edges without a seam
// that touch corrected corners.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#ifdef SMOOTH
#include "fields.glsl"

PAGED(13, readonly, Fields, fields); // of the samples
#endif
#include "seams.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint start;        // number of the first thread: seam * points + point
    uint first_sample; // number of the first jet: side * points + point
    uint rule;
    Lattice lattice;
} params;

PAGED(6, readonly, Seam, seams);
PAGED(7, readonly, SeamSide, seam_sides);
PAGED(8, readonly, mat3, jets);
PAGED(9, writeonly, vec3, positions);
PAGED(10, , uint, counters);

const uint MISMATCH = 2u;

void element(uint i) {
    i += params.start;
    uint points = (1u << params.lattice.level) - 1u;
    uint list = i / points;
    uint point = i - list * points;
    Seam seam = LOAD(seams, list);
    vec3 displacement = vec3(0.0);
    vec3 dominant = vec3(0.0);
    float worst = 0.0;
    for (uint rank = 0u; rank < seam.count; ++rank) {
        if (LOAD(seam_sides, seam.first + rank).same_as != rank) {
            continue;
        }
        vec3 candidate = LOAD(jets, (seam.first + rank) * points + point - params.first_sample)[0];
        dominant = rank == 0u ? candidate : dominant;
        worst = max(worst, length(candidate - dominant));
        precise vec3 sum = displacement + candidate * share(seam, params.rule, rank);
        displacement = sum;
    }
    float t = float(point + 1u) / float(points + 1u);
#ifdef SMOOTH
    vec3 base = LOAD(fields, seam.first * points + point - params.first_sample).position[0];
#else
    vec3 base = edge_position(LOAD(seam_sides, seam.first).id, t);
#endif
    precise vec3 position = base + displacement;
    for (uint rank = 0u; rank < seam.count; ++rank) {
        uint edge = LOAD(seam_sides, seam.first + rank).id;
        STORE(positions, params.lattice.corners + edge * points + point, position);
    }
    atomicMax(ELEMENT(counters, MISMATCH), floatBitsToUint(worst));
}

#include "batch.glsl"
