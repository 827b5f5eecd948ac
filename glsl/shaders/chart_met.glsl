// What a ray meets at the border of a chart, and the triangle that lies where something is met. Include after
// chart_foot.glsl and relief_slope.glsl. Needs `course_nodes`, params.finds_depth, params.tests. Twin:
// reference/relief/bordered.rs.

struct Met {
    bool found;
    bool is_level; // at a border, beyond which heights count as what they are there
    float t;       // along the ray
    vec2 place;    // texels of the level
    float lift;    // from there up to the heights, which a step may have gone below
};

// Beyond a seam the surface goes on: a ray that comes from there below it has struck it, and one that leaves above it
// comes down to it. What is shown is decided already: there it also goes on where nothing lies beyond.
Met met_at_border(Relief relief, Course course, uint first, float fall, Met met) {
    vec4 near = LOAD(course_nodes, first);
    vec4 far = LOAD(course_nodes, first + course.nodes - 1u);
    if ((course.ends & 15u) == WAY_SEAM && height_at_place(relief, course.level, near.xy) >= near.z) {
        return Met(true, true, near.w, near.xy, 0.0);
    }
    uint end = course.ends >> 4;
    if (met.found || !(end == WAY_SEAM || (end == WAY_OPEN && params.tests == 0u))) {
        return met;
    }
    float above = far.z - height_at_place(relief, course.level, far.xy);
    return above >= 0.0 ? Met(true, true, far.w + above * fall, far.xy, 0.0) : met;
}

// From the foot to what is met. Places alone are kept in the chart as it lies on the map.
Way way_to(Relief relief, SurfacePoint point, Foot foot, vec2 size, inout Met met) {
    Way way = way_of(foot, point.triangle, met.t < foot.t ? -1.0 : 1.0);
    if (params.finds_depth != 0u) {
        follow(relief, way, abs(met.t - foot.t));
        return way;
    }
    way.rate = (met.place + 0.5) / size - foot.place;
    way.bends = MOST_BENDS;
    follow(relief, way, 1.0);
    met.place = way.end == WAY_INSIDE ? met.place : place_on(way, way.t) * size - 0.5;
    return way;
}

// Changes of weights that change a place by `way`; 0 where the corners have no area on the map.
vec3 weights_along(mat3x2 corners, vec2 way) {
    mat2 sides = mat2(corners[1] - corners[0], corners[2] - corners[0]);
    float area = crossed(sides[0], sides[1]);
    vec2 change = area != 0.0 ? vec2(crossed(way, sides[1]), crossed(sides[0], way)) / area : vec2(0.0);
    return vec3(-change.x - change.y, change);
}

// Moves the point to the triangle that lies where something is met; what is to be added to places of that, texels.
vec2 moved(inout SurfacePoint point, Relief relief, Foot foot, vec2 size, inout Met met) {
    Way way = way_to(relief, point, foot, size, met);
    if (way.triangle != point.triangle) {
        mat3x2 places = places_of(relief, point.vertices);
        point.triangle = way.triangle;
        point.vertices = LOAD(triangles, way.triangle);
        mat3x2 there = places_of(relief, point.vertices);
        point.at_dx = weights_along(there, places * point.at_dx);
        point.at_dy = weights_along(there, places * point.at_dy);
    }
    return way.turns * size;
}
