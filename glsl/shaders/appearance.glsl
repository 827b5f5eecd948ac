// What a surface looks like under a fragment: what shading needs to know, whatever the maps it came from.
// Mirrored in layout.rs.
struct Appearance {
    vec4 base;       // linear base colour and alpha
    vec3 emissive;   // linear radiance
    float metallic;
    vec3 normal;     // world, unit: of the normal map where there is one; zero where there is none
    float roughness; // perceptual: alpha of GGX is its square
    float occlusion; // share of light from everywhere that arrives
    uint flags;      // MATERIAL_*
};
