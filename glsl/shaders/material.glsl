// Factors of a material (glTF 2.0, 3.9). Mirrored in layout.rs.
struct Material {
    vec4 base_color; // linear
    vec3 emissive;   // linear radiance
    float metallic;
    float roughness;
    float normal_scale;
    float occlusion_strength;
    float alpha_cutoff;
    uint flags; // MATERIAL_*
};

// Base colour is what is seen, whatever the light (KHR_materials_unlit).
const uint MATERIAL_UNLIT = 1u;
// Its normals come from a map.
const uint MATERIAL_NORMAL_MAP = 2u;
// Samples keep it by chance, as likely as its alpha says.
const uint MATERIAL_STOCHASTIC = 4u;
