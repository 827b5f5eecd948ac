// Heights that are shown per pixel: what materials have of them, the way of a ray over them, and what is found there.
// Mirrored in layout/relief.rs.

// How a material shows heights per pixel.
struct Relief {
    vec3 map_u;            // rows of the affine map from texture coordinates to u and v of the map
    vec3 map_v;
    uint uv_channel;       // of each vertex
    uint wrap;             // along u, and along v two bits up: WRAP_REPEAT or WRAP_CLAMP
    uint level_first;      // into the levels, finest first
    uint level_count;      // 0: the material has no relief
    float low;             // least height, mesh-local units
    float high;            // greatest
    float thinnest_texels; // width of the thinnest feature, texels of the finest level
    uint steps;            // linear steps of a march; 0: as many as the angle asks for
};

// A level of a height map. Texel (i, j) is at x = i, y = j, heights are bilinear between: cell (i, j) lies between texels
// (i, j) and (i + 1, j + 1), and there are as many cells as texels. Heights, bounds and cones are words of `texels`.
struct ReliefLevel {
    uvec2 size;        // texels
    uint height_first; // heights, mesh-local units, row by row
    uint bound_first;  // greatest height of every cell, then of each 2 x 2 of those, until one is left; sizes rounded up
    uint cone_first;   // of every texel, where the method needs them
};

// The way of a ray over a height map: straight between nodes (x, y, z, t), x and y in texels of the level, z the height
// above the base, mesh-local units, t along the ray, growing away from where it starts. COURSE_NODES are kept for each ray.
struct Course {
    uint nodes;    // 0: nothing is marched
    uint material;
    uint level;    // of the material's, from the finest
    float cosine;  // of the ray and the base's normal, at the base
    uint ends;     // how it begins, WAY_*, and how it ends, four bits up; one node alone is all beyond a border
};

// What is beyond each side of a triangle, which leads from corner k to the next.
struct ChartSides {
    uvec3 across; // the triangle there, of all meshes; CHART_OPEN or CHART_SEAM
    uvec3 how;    // its side, 2 bits; 1 bit: it is mirrored on the map; what is to be added to its places, 14 bits each
};

// Nothing of the mesh is there.
const uint CHART_OPEN = 0xFFFFFFFFu;
// The surface goes on, and is elsewhere on the map.
const uint CHART_SEAM = 0xFFFFFFFEu;

// How a way over charts ends.
const uint WAY_INSIDE = 0u; // on the chart, or nobody knows
const uint WAY_OPEN = 1u;
const uint WAY_SEAM = 2u;
const uint WAY_BENT = 3u;   // not yet: it goes on mirrored
const uint WAY_LEADS = 4u;  // not yet

const uint COURSE_NODES = 9u;

// What a method found: s counts nodes, fractions lie between two; MISSED where the surface is not met.
struct March {
    float s;
    vec2 place;   // where maps are read, texels of the level
    uint fetches; // values, bounds and cones that were read: four texels of a bilinear value are one
    uint steps;
    uint capped;  // 1: it ended because it may take no more steps
};

const float MISSED = -1.0;

// Where a ray has met a height map, or the border of its chart.
struct Landing {
    vec3 x;     // mesh-local
    vec2 place; // texels of the level
    vec2 turns; // what is to be added to places of the triangle there, texels
    uint kind;  // LANDED_*
    float lift; // from there up to the heights, which a step may have gone below, mesh-local units
};

const uint LANDED_NOWHERE = 0u;
const uint LANDED = 1u;
const uint LANDED_LEVEL = 2u; // at a border, beyond which heights count as what they are there
