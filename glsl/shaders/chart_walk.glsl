// Follows a straight way over a height map from triangle to triangle, as far as they are of one chart. A chart goes on where
// the map repeats, and, bent, where it is mirrored. Needs `triangles`, `positions`, `uvs`, `chart_sides`, params.uv_channels.
// Twin: reference/relief/charts.rs.

// Of triangles; beyond as many, a way goes on as if there were no border.
const uint MOST_CROSSED = 64u;
const uint MOST_BENDS = 3u;

struct Way {
    uint triangle; // that it has come to, of all meshes
    uint entry;    // the side it came in by; 3: it began there
    vec2 turns;    // what is to be added to places of the triangle
    vec2 from;     // its place where t is 0, as if it had been straight; the map is 1 wide and high
    vec2 rate;     // of the place, by t
    float t;       // so far it is inside
    uint end;      // WAY_*
    uint bends;
    vec3 bend[MOST_BENDS]; // place and t
};

Way way_from(uint triangle, vec2 place, vec2 rate) {
    Way way;
    way.triangle = triangle;
    way.entry = 3u;
    way.turns = vec2(0.0);
    way.from = place;
    way.rate = rate;
    way.t = 0.0;
    way.end = WAY_LEADS;
    way.bends = 0u;
    return way;
}

vec2 place_on(Way way, float t) {
    return way.from + way.rate * t;
}

// Of corners, on the map.
mat3x2 places_of(Relief relief, uvec3 vertices) {
    mat3x2 places;
    for (int k = 0; k < 3; ++k) {
        vec3 uv = vec3(LOAD(uvs, vertices[k] * params.uv_channels + relief.uv_channel), 1.0);
        places[k] = vec2(dot(relief.map_u, uv), dot(relief.map_v, uv));
    }
    return places;
}

float crossed(vec2 a, vec2 b) {
    return a.x * b.y - a.y * b.x;
}

// What lies across a side on the surface lies on its near side on the map.
void bend(inout Way way, uvec3 vertices, mat3x2 places, uint side) {
    uint next = (side + 1u) % 3u;
    uint last = (side + 2u) % 3u;
    vec3 corner = LOAD(positions, vertices[side]);
    vec3 edge = LOAD(positions, vertices[next]) - corner;
    float share = dot(LOAD(positions, vertices[last]) - corner, edge) / dot(edge, edge);
    vec2 along = places[next] - places[side];
    vec2 across = places[last] - places[side] - share * along;
    vec2 place = place_on(way, way.t);
    way.rate -= across * (2.0 * crossed(along, way.rate) / crossed(along, across));
    way.from = place - way.rate * way.t;
    way.end = way.bends == MOST_BENDS ? WAY_SEAM : WAY_BENT;
    if (way.end == WAY_BENT) {
        way.bend[way.bends] = vec3(place, way.t);
        way.bends += 1u;
    }
}

// Out of the triangle it is in, unless it gets to `until` before.
void cross_side(Relief relief, inout Way way, float until) {
    uvec3 vertices = LOAD(triangles, way.triangle);
    mat3x2 places = places_of(relief, vertices);
    float turn = sign(crossed(places[1] - places[0], places[2] - places[0]));
    float leaves = until;
    uint side = 3u;
    for (uint k = 0u; k < 3u; ++k) {
        vec2 along = places[(k + 1u) % 3u] - places[k];
        float rate = turn * crossed(way.rate, along);
        float gap = turn * crossed(places[k] + way.turns - way.from, along);
        if (k != way.entry && rate > 0.0 && gap < leaves * rate) {
            leaves = gap / rate;
            side = k;
        }
    }
    way.t = side == 3u ? until : max(way.t, leaves);
    if (side == 3u) {
        way.end = WAY_INSIDE;
        return;
    }
    ChartSides sides = LOAD(chart_sides, way.triangle);
    uint across = sides.across[side];
    if (across >= CHART_SEAM) {
        way.end = across == CHART_OPEN ? WAY_OPEN : WAY_SEAM;
        return;
    }
    int how = int(sides.how[side]);
    if ((how & 4) != 0) {
        for (int k = 0; k < 3; ++k) {
            places[k] += way.turns;
        }
        bend(way, vertices, places, side);
    }
    way.turns += vec2(bitfieldExtract(how, 3, 14), bitfieldExtract(how, 17, 14));
    way.entry = uint(how) & 3u;
    way.triangle = across;
}

// On until t is `until`, or a border is met.
void follow(Relief relief, inout Way way, float until) {
    way.end = WAY_LEADS;
    [[dont_unroll]] for (uint n = 0u; n < MOST_CROSSED && way.end >= WAY_BENT; ++n) {
        cross_side(relief, way, until);
    }
    if (way.end >= WAY_BENT) {
        way.t = until;
        way.end = WAY_INSIDE;
    }
}
