// What a fragment sees of an environment. Mirrored in layout.rs.
struct Surroundings {
    vec3 diffuse; // irradiance over pi
    vec3 facing;  // mean radiance over the lobe, weighed by what Fresnel reflects as from the front
    vec3 grazing; // the same, weighed by what it adds at grazing angles
};
