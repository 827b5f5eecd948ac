// How materials bend normals (Blinn 1978), by surface gradients, which add (Mikkelsen 2010). Mirrored in layout/bump.rs.
// Include after raster_tables.glsl.

// How a material bends its normals besides its own normal map.
struct Bump {
    uvec4 kinds; // BUMP_*, of the maps in MAP_DETAIL and the slots after it
    vec4 scales;
    uint expression_first; // into the formulas
    uint expression_count;
    uint flags;
};

// Heights from a formula, as a material uses it.
struct BumpFormula {
    vec3 map_u; // rows of the affine map to its u and v
    vec3 map_v;
    uint uv_channel;
    uint first; // into the instructions
    uint count;
    float scale;
};

const uint BUMP_SLOTS = 4u;
const uint MOST_FORMULAS = 8u;

// What the map of a slot holds.
const uint BUMP_NONE = 0u;
const uint BUMP_HEIGHT = 1u;  // slopes of a height by u and v of the map, in r and g
const uint BUMP_TANGENT = 2u; // a normal, in the frame of MikkTSpace
const uint BUMP_OBJECT = 3u;  // a normal, in the mesh's space
const uint BUMP_CYSLICE = 4u; // a normal, in the frame that CySlice's shader prints

// The normal is bent from that of the triangle, as West's bump shaders do (2007).
const uint BUMP_FACETED = 1u;

// The steepest slope of a normal map; a normal within half a degree of the surface has it.
const float STEEPEST = 128.0;

// The gradient along the surface of what rises by `rises` along two sides of a triangle: across normal n, and of the
// triangle's geometry alone, so that UVs may be mirrored or have no area (Mikkelsen 2010).
vec3 surface_gradient(vec3 side_1, vec3 side_2, vec3 n, vec2 rises) {
    vec3 a = cross(side_2, n);
    float volume = dot(side_1, a);
    return volume != 0.0 ? (rises.x * a + rises.y * cross(n, side_1)) / volume : vec3(0.0);
}

// Of a normal of a tangent frame: how much x and y there is for one z (Mikkelsen 2020).
vec2 leaning(vec3 m) {
    float least = max(max(abs(m.x), abs(m.y)) / STEEPEST, 1e-20);
    return m.xy / max(abs(m.z), least);
}

// A direction around unit n whose share along n is 1, or as much as a steep one has.
vec3 homogeneous(vec3 direction, vec3 n) {
    return direction / max(dot(direction, n), 1.0 / STEEPEST);
}
