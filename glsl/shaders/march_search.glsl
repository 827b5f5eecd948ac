// What the methods share that step along a course until the ray is below the surface and then narrow down where it went
// below. Include after march.glsl. Ways are told in parts of even steps, whole numbers: nothing adds up that rounding
// could change, and what is found depends on the signs of gaps alone.

const uint PARTS = 32u;           // of an even step: what five bisections leave
const uint MOST_BISECTIONS = 14u; // of all parts of the most steps

// s of a part, steps being those of the whole course.
float part_of(Trip trip, uint steps) {
    return float(trip.course.nodes - 1u) / float(steps * PARTS);
}

// How high the ray is above the surface: one fetch.
float gap_at(Trip trip, float s) {
    vec4 place = place_at(trip, s);
    return place.z - height_at(trip, place.xy);
}

// Where even steps first lead from above the surface to on or below it.
struct Crossing {
    bool found;
    uint step; // the first below; the last of all where nothing is met
    float above_gap;
    float below_gap;
};

Crossing crossing_of(Trip trip, uint steps) {
    float part = part_of(trip, steps);
    Crossing crossing = Crossing(false, steps, 0.0, 0.0);
    [[dont_unroll]] for (uint k = 0u; k <= steps; ++k) {
        crossing.below_gap = gap_at(trip, float(k * PARTS) * part);
        if (crossing.above_gap > 0.0 && crossing.below_gap <= 0.0) {
            crossing.found = true;
            crossing.step = k;
            break;
        }
        crossing.above_gap = crossing.below_gap;
    }
    return crossing;
}

// The march of a crossing that is at s.
March met_at(Trip trip, float s, Crossing crossing) {
    return March(s, place_at(trip, s).xy, crossing.step + 1u, crossing.step, 0u);
}

March nothing_met(Crossing crossing) {
    return March(MISSED, vec2(0.0), crossing.step + 1u, crossing.step, 0u);
}

// Halves the way between a part above the surface and one on or below it until they are neighbours; the one below is
// what is found.
March bisected(Trip trip, float part, uint above, uint below, March march) {
    [[dont_unroll]] for (uint k = 0u; k < MOST_BISECTIONS && below - above > 1u; ++k) {
        uint middle = (above + below) / 2u;
        bool is_below = gap_at(trip, float(middle) * part) <= 0.0;
        above = is_below ? above : middle;
        below = is_below ? middle : below;
        march.fetches += 1u;
    }
    march.s = float(below) * part;
    march.place = place_at(trip, march.s).xy;
    return march;
}
