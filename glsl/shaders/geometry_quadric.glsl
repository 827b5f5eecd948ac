// A ray over the quadric that a bent surface is near to, from where it strikes the base as it is raised by the greatest
// height (Oliveira and Policarpo 2005). The surface bends away from the plane through a place by r.S r, S being a symmetric
// tensor of half the normal curvature, negative where it is convex. Twin: reference/relief/quadric.rs.
#include "geometry_prism.glsl"

// S of a triangle's corners, per mesh-local unit: rows (xx, xy, xz) and (yy, yz, zz).
struct Bends {
    mat3 first;
    mat3 second;
};

// A ray over the quadric of the place where it struck. Heights are in units of the prism, times count from there.
struct Flight {
    float t; // along the ray, where it strikes; in time of the ray
    vec3 weights;
    vec3 weights_rate;
    float height;
    float height_rate;
    float bend; // how the height grows with the square of the time
    bool strikes;
};

// Concave surfaces are not raised to where they meet themselves.
const float LEAST_GROWTH = 0.25;

vec3 bent(Prism prism, Bends bends, vec3 weights, vec3 r) {
    vec3 first = bends.first * weights * prism.side;
    vec3 second = bends.second * weights * prism.side;
    return vec3(
        dot(first, r), dot(vec3(first.y, second.xy), r), dot(vec3(first.z, second.yz), r));
}

// Of the parallel surface at a height: a curvature k is k / (1 + height k) there.
float raised_bend(float bend, float along_squared, float height) {
    if (along_squared <= 0.0) {
        return 0.0;
    }
    return bend / max(1.0 - 2.0 * height * bend / along_squared, LEAST_GROWTH);
}

// Where a ray, in units of the prism, strikes the front of the triangle at k: of a prism whose directions are unit.
Flight strike_of(Prism prism, Bends bends, float k, vec3 origin, vec3 direction) {
    Flight flight;
    mat3 raised = prism.corners + k * prism.directions;
    vec3 e1 = raised[1] - raised[0];
    vec3 e2 = raised[2] - raised[0];
    vec3 normal = cross(e1, e2);
    float facing = -dot(normal, direction);
    vec3 from = origin - raised[0];
    vec3 across = cross(from, direction);
    flight.strikes = facing > 0.0;
    float over = facing > 0.0 ? facing : 1.0;
    flight.t = dot(normal, from) / over;
    vec2 b = vec2(dot(e2, across), -dot(e1, across)) / over;
    flight.weights = vec3(1.0 - b.x - b.y, b);
    flight.strikes = flight.strikes && is_inside(flight.weights);
    mat3 jacobian = prism_jacobian(prism, flight.weights, k);
    vec3 rates = solved(jacobian, direction);
    flight.weights_rate = vec3(-rates.x - rates.y, rates.xy);
    float size = length(jacobian[2]);
    vec3 upright = jacobian[2] / size;
    flight.height = k * size;
    flight.height_rate = dot(direction, upright);
    vec3 along = direction - upright * flight.height_rate;
    float bend = dot(along, bent(prism, bends, flight.weights, along));
    flight.bend = raised_bend(bend, dot(along, along), flight.height);
    return flight;
}

// How long it takes to a height, the first or the last time; 0 if never.
float time_to(Flight flight, float level, bool is_first) {
    float above = flight.height - level;
    float discriminant = flight.height_rate * flight.height_rate + 4.0 * above * flight.bend;
    float q = 0.5 * (sqrt(max(discriminant, 0.0)) - flight.height_rate);
    float over = is_first ? q : -flight.bend;
    float time = over != 0.0 ? (is_first ? above : q) / over : 0.0;
    return discriminant >= 0.0 && time > 0.0 && time < 1e30 ? time : 0.0;
}

// How long a ray stays between the heights: until it leaves them below, or above where the surface bends away; 0 if it does
// not come between them.
float time_of(Prism prism, Flight flight) {
    if (!flight.strikes || flight.height_rate >= 0.0) {
        return 0.0;
    }
    float below = time_to(flight, prism.heights.x, true);
    return below > 0.0 ? below : time_to(flight, prism.heights.y, false);
}

// Weights, and the height in units of the prism, after a time.
vec4 flight_at(Flight flight, float time) {
    float height = flight.height + time * (flight.height_rate - time * flight.bend);
    return vec4(flight.weights + flight.weights_rate * time, height);
}
