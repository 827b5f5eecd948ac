// Samples: the places where details are evaluated with derivatives. Several samples, weighted, make the
// displacement of one vertex of one base triangle: its own detail, and the sides of its seams.

// `detail` is NONE where there is nothing to evaluate. The sample's jet counts with the jet `weight`;
// its derivatives along the site's b1 and b2 turn into those along the vertex's by the factors `turn`.
struct Sample {
    uvec3 av;
    uint detail;
    vec2 b;
    uint patch_code; // where the site lies on a smooth base
    vec3 weight;
    vec2 turn;
};

const uint NONE = 0xffffffffu;
