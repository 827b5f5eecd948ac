// How the normals of what a fragment covers scatter around its own: one standard deviation of their slopes over the plane
// across it, along the principal axes. World, at right angles to the normal and to each other, `major` no shorter. Stored
// so, the covariance major major^T + minor minor^T has no negative eigenvalue. Mirrored in layout.rs.
struct Spread {
    vec3 major;
    vec3 minor;
};
