// What the methods share that shift where maps are read instead of finding what the ray meets. Include after march.glsl.

// Where a ray meets the base.
struct Base {
    float s;
    vec4 place;
    vec2 slope; // texels towards the viewer for each unit of height
};

// The height 0 of a course of two nodes, or the end that is nearer to it.
Base base_of(Trip trip) {
    vec4 first = node_of(trip, 0u);
    vec4 last = node_of(trip, 1u);
    float down = first.z - last.z;
    if (down <= 0.0) {
        return Base(0.0, first, vec2(0.0));
    }
    float s = clamp(first.z / down, 0.0, 1.0);
    return Base(s, place_at(trip, s), (first.xy - last.xy) / down);
}

// Maps are read where the ray is at a height.
March shifted(Base base, float height, uint fetches) {
    return March(base.s, base.place.xy + (height - base.place.z) * base.slope, fetches, fetches, 0u);
}
