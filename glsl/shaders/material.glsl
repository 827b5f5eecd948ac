// What a material looks like. Mirrored in layout.rs.
struct Material {
    vec4 base_color; // linear
    vec3 map_u;      // rows of the texture transform
    vec3 map_v;
    float alpha_cutoff;
    uint wrap;        // along u, and along v two bits up
    uint level_first;
    uint level_count; // 0: no map
};

const uint WRAP_REPEAT = 0u;
const uint WRAP_MIRROR = 1u;
const uint WRAP_CLAMP = 2u;
