// How a fragment lies under a projection. Mirrored in layout.rs.
struct ProjectedFrame {
    vec3 tangent;   // unit, in the mesh's space, towards growing u
    float weight;
    vec3 bitangent; // towards shrinking v
};
