// Where the ray of a fragment passes its triangle, and how it goes on over the map. Include after chart_walk.glsl. Twin: reference/relief/bordered.rs.

struct Foot {
    vec2 place; // on the map, which is 1 wide and high
    vec2 rate;  // of it, by t
    float t;    // along the ray
    float rise; // height by t; below 0
};

// To or from the viewer, from the foot; t grows along the way.
Way way_of(Foot foot, uint triangle, float sense) {
    return way_from(triangle, foot.place, sense * foot.rate);
}
