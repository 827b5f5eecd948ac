#version 460
// The first root of ray and bilinear surface, in closed form, found over a pyramid of greatest heights (Tevs, Ihrke and
// Seidel 2008) or cell by cell where the way is short. Both find the same bits: which cell a ray is in, and over which
// range of t, follows from the numbers of lattice lines alone, and a node is passed by only where rounding can find
// nothing in it. The setting: pieces that cross fewer lattice lines than this are walked cell by cell.
#include "march.glsl"
#include "exact_piece.glsl"
#include "exact_leaf.glsl"
#include "exact_walk.glsl"

// Nodes and cells that a march reads at most: 4 (W + H) of a map of 8192 x 8192, or of 32 of 256 x 256 in a row. A piece
// over n lattice lines reads no node twice, 2 n + 64 in all at most.
const uint MOST_READS = 1u << 16;

// Over a map of one texel, which is as high everywhere, however often it is repeated.
March level_march(Trip trip, float height) {
    bool above = false;
    [[dont_unroll]] for (uint k = 0u; k + 1u < min(trip.course.nodes, COURSE_NODES); ++k) {
        vec4 from = node_of(trip, k);
        vec4 to = node_of(trip, k + 1u);
        above = above || from.z >= height;
        if (above && to.z < min(from.z, height)) {
            float t = clamp((height - from.z) / (to.z - from.z), 0.0, 1.0);
            return March(float(k) + t, mix(from.xy, to.xy, t), 1u, 1u, 0u);
        }
    }
    return March(MISSED, vec2(0.0), 1u, 1u, 0u);
}

March marched(Trip trip) {
    if (all(equal(trip.level.size, uvec2(1u)))) {
        return level_march(trip, LOAD_TEXEL(trip.level.height_first));
    }
    ivec2 ends = ends_of(trip);
    uint pieces = min(trip.course.nodes, COURSE_NODES) - 1u;
    March march = March(MISSED, vec2(0.0), 0u, 0u, 0u);
    bool above = false;
    // At a border beyond which nothing lies only what is met there counts.
    bvec2 closed = notEqual(uvec2(trip.course.ends & 15u, trip.course.ends >> 4), uvec2(WAY_OPEN));
    [[dont_unroll]] for (uint k = 0u; k < pieces && march.s < 0.0; ++k) {
        Piece piece = piece_of(trip, k);
        Walk walk = walk_from(trip, piece, ends, above);
        float found = NOWHERE;
        [[dont_unroll]] while (found < 0.0 && walk.t < 1.0 && march.fetches < MOST_READS) {
            // Threads that run together go down to cells together.
            [[dont_unroll]] while (walk.level > 0 && walk.t < 1.0 && march.fetches < MOST_READS) {
                march.fetches += 1u;
                visit_node(trip, piece, ends, walk);
            }
            if (walk.t < 1.0 && march.fetches < MOST_READS) {
                march.fetches += 1u;
                found = visit_cell(trip, piece, ends, walk, bvec2(k == 0u && closed.x, k + 1u == pieces && closed.y));
            }
        }
        above = walk.above;
        march.capped = found < 0.0 && walk.t < 1.0 ? 1u : 0u;
        found = march.capped != 0u ? walk.t : found;
        if (found >= 0.0) {
            march.s = float(k) + found;
            march.place = place_of(piece, found);
        }
    }
    march.steps = march.fetches;
    return march;
}

#include "march_pass.glsl"
