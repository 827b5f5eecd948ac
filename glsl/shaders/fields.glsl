// The frame of a smooth base at a site, without what attribute vertices blend.

// Normals are unit, directions per unit of height.
struct Fields {
    mat3 position;
    mat3 normal;
    mat3 direction;
};
