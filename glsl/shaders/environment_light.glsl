// What surfaces see of an environment, beyond mirrors. Include after environment.glsl; needs in scope
//   PAGED(b, readonly, vec3, harmonics);  9 factors of irradiance over pi

// Irradiance over pi on a surface that faces n: what a white diffuse one sends out (Ramamoorthi and Hanrahan 2001). Never
// below 0, where nine terms swing through it.
vec3 environment_diffuse(vec3 n) {
    vec3 sum = LOAD(harmonics, 0u) + n.y * LOAD(harmonics, 1u) + n.z * LOAD(harmonics, 2u) + n.x * LOAD(harmonics, 3u);
    sum += n.x * n.y * LOAD(harmonics, 4u) + n.y * n.z * LOAD(harmonics, 5u);
    sum += (3.0 * n.z * n.z - 1.0) * LOAD(harmonics, 6u) + n.x * n.z * LOAD(harmonics, 7u);
    sum += (n.x * n.x - n.y * n.y) * LOAD(harmonics, 8u);
    return max(sum, 0.0);
}
