#version 460
// Relaxed cone stepping (Policarpo and Oliveira 2007, after Dummer 2006): from each place as far as the cone of its cell
// reaches, in which a ray that descends goes below the surface at most once, and bisections of the step that ends below.
//
// Near what a ray passes cones are short. So no step is shorter than what is left divided by the steps that are left, the
// most being those of even steps: what cones save is spent where they are short, and the steps always lead to the end.
// Beyond cones no step is longer than an even one. Where a course rises cones say nothing.
#include "march.glsl"
#include "march_search.glsl"

const uint LEAST_PARTS = PARTS / 2u;

float cone_at(Trip trip, vec2 place) {
    ivec2 size = ivec2(trip.level.size);
    int x = tiled(int(floor(place.x)), size.x, trip.relief.wrap & 3u);
    int y = tiled(int(floor(place.y)), size.y, trip.relief.wrap >> 2);
    uint at = trip.level.cone_first + uint(y * size.x + x);
    return LOAD_TEXEL(at);
}

// Parts from one that is above the surface by a gap until the ray leaves the cone: it does where its way across is the
// cone times its height above the apex.
uint parts_within(Trip trip, float part, uint all, uint at, float gap, inout March march) {
    uint ways = trip.course.nodes - 1u;
    uint k = at * ways / all;
    vec4 along = node_of(trip, k + 1u) - node_of(trip, k);
    if (along.z > 0.0) {
        return 0u;
    }
    march.fetches += 1u;
    float cone = cone_at(trip, place_at(trip, float(at) * part).xy);
    float reach = cone * gap / max(length(along.xy) - cone * along.z, 1e-30);
    // Cones hold for rays that are straight, as they are up to the next node.
    return min(uint(min(reach / part, float(all))), (k + 1u) * all / ways - at);
}

March marched(Trip trip) {
    uint steps = steps_of(trip);
    uint all = steps * PARTS;
    float part = part_of(trip, steps);
    March march = March(MISSED, vec2(0.0), 0u, 0u, 0u);
    uint at = 0u;
    uint above = 0u;
    bool was_above = false;
    [[dont_unroll]] for (uint k = 0u; k <= steps; ++k) {
        float gap = gap_at(trip, float(at) * part);
        march.fetches += 1u;
        march.steps = k;
        if (was_above && gap <= 0.0) {
            return bisected(trip, part, above, at, march);
        }
        if (at == all) {
            break;
        }
        was_above = gap > 0.0;
        above = at;
        uint left = steps - k;
        uint within = was_above ? parts_within(trip, part, all, at, gap, march) : 0u;
        at = min(at + max(within, max((all - at + left - 1u) / left, LEAST_PARTS)), all);
    }
    return march;
}

#include "march_pass.glsl"
