// What a fragment sees of an environment. Mirrored in layout.rs.
struct Surroundings {
    vec3 diffuse;  // irradiance over pi
    vec3 specular; // radiance, mean over the lobe around the mirrored direction
};
