// A straight piece of a course, from t = 0 to 1, over lattice lines. Include after march.glsl.

// Half an ulp of 1.
const float ROUNDING = 5.9604644775390625e-8;
// The inverse of a direction that is none.
const float NEVER = 1e30;

struct Piece {
    vec2 origin;
    vec2 direction;
    vec2 inverse;
    float z;
    float fall;
    float fall_inverse;
    float slack; // what rounding may do to a gap
};

Piece piece_of(Trip trip, uint k) {
    vec4 from = node_of(trip, k);
    vec4 to = node_of(trip, k + 1u);
    Piece piece;
    piece.origin = from.xy;
    piece.direction = to.xy - from.xy;
    bvec2 still = lessThan(abs(piece.direction), vec2(1.0 / NEVER));
    piece.inverse = mix(1.0 / piece.direction, vec2(NEVER), still);
    piece.z = from.z;
    piece.fall = to.z - from.z;
    piece.fall_inverse = abs(piece.fall) < 1.0 / NEVER ? -NEVER : 1.0 / piece.fall;
    vec2 reach = abs(piece.origin) + abs(piece.direction);
    vec2 range = vec2(trip.relief.low, trip.relief.high);
    float heights = abs(from.z) + abs(to.z) + max(abs(range.x), abs(range.y));
    piece.slack = ROUNDING * (16.0 * heights + 32.0 * (range.y - range.x) * (1.0 + max(reach.x, reach.y)));
    return piece;
}

vec2 place_of(Piece piece, float t) {
    precise vec2 place = piece.origin + piece.direction * t;
    return place;
}

// The t at which lattice lines are crossed: from their numbers alone.
vec2 crossing(Piece piece, vec2 lines) {
    precise vec2 t = (lines - piece.origin) * piece.inverse;
    return t;
}

// 1 along axes on which cells count up.
vec2 forward_of(Piece piece) {
    return vec2(greaterThan(piece.inverse, vec2(0.0)));
}

// The cell that the piece is in at t: rounding makes the guess wrong by one at most.
vec2 cell_at(Piece piece, float t) {
    vec2 forward = forward_of(piece);
    vec2 guess = floor(place_of(piece, t));
    vec2 leaves = crossing(piece, guess + forward);
    vec2 enters = crossing(piece, guess + 1.0 - forward);
    vec2 by = vec2(lessThanEqual(leaves, vec2(t))) - vec2(greaterThan(enters, vec2(t)));
    return guess + (2.0 * forward - 1.0) * by;
}

// Up to which t the piece is above a height, and not within rounding of it.
float clear_until(Piece piece, float height, float t) {
    precise float lifted = height + 2.0 * piece.slack;
    precise float until = (lifted - piece.z) * piece.fall_inverse;
    precise float z = piece.z + piece.fall * t;
    return piece.fall < 0.0 ? until : z > lifted ? NEVER : -1.0;
}
