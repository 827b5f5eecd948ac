// A triangle as a plane that goes on, with heights along one normal. Twin: reference/relief/flat.rs.

struct Plane {
    mat3 across;  // rows that take a way to shares of both sides and of the normal
    vec3 normal;  // unit; zero where there is none
    float side;   // longest side
    float volume; // of sides and normal; 0: there is no such plane
};

Plane plane_of(mat3 corner, vec3 normal) {
    Plane plane;
    vec3 a = corner[1] - corner[0];
    vec3 b = corner[2] - corner[0];
    plane.side = sqrt(max(max(dot(a, a), dot(b, b)), dot(b - a, b - a)));
    float squared = dot(normal, normal);
    plane.normal = squared > 1e-30 && squared < 1e30 ? normal * inversesqrt(squared) : vec3(0.0);
    // In units of the longest side, so that nothing under- or overflows.
    a /= plane.side;
    b /= plane.side;
    vec3 face = cross(a, b);
    plane.volume = plane.side > 0.0 ? dot(face, plane.normal) : 0.0;
    float over = plane.volume != 0.0 ? 1.0 / plane.volume : 0.0;
    plane.across = mat3(
        cross(b, plane.normal) * (over / plane.side), cross(plane.normal, a) * (over / plane.side), face * over);
    return plane;
}

// Shares of the second and third corner, and mesh-local height, of a way from the first corner.
vec3 in_plane(Plane plane, vec3 way) {
    return way * plane.across;
}

vec3 weights_of(vec3 place) {
    return vec3(1.0 - place.x - place.y, place.xy);
}


// Rays begin above what is as high as any and end below what is as low.
vec2 with_margin(Plane plane, vec2 heights) {
    float margin = max((heights.y - heights.x) / 64.0, plane.side / 4096.0);
    return heights + vec2(-margin, margin);
}
