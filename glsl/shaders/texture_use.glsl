// A map as a material uses it, `MAP_SLOTS` of them for each material. Mirrored in layout.rs.
struct TextureUse {
    vec3 map_u;       // rows of the texture transform
    vec3 map_v;
    uint wrap;        // along u, and along v two bits up
    uint uv_channel;
    uint level_first;
    uint level_count; // 0: no map
};

// What a place of the slots holds.
const uint MAP_BASE_COLOR = 0u;
const uint MAP_NORMAL = 1u;
const uint MAP_METALLIC_ROUGHNESS = 2u;
const uint MAP_OCCLUSION = 3u;
const uint MAP_EMISSIVE = 4u;
const uint MAP_NORMAL_MOMENTS = 5u; // of the slopes in the place of normals
const uint MAP_DETAIL = 6u; // the first of four; what they hold, `Bump` says
const uint MAP_SLOTS = 10u;
