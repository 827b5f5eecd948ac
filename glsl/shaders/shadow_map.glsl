// A side of what a light sees: the nearest depths of its texels' four samples. Mirrored in layout/shadow.rs.
struct ShadowFace {
    vec4 row_x; // world to homogeneous texels (x w, y w, z, w), z the reversed depth
    vec4 row_y;
    vec4 row_z;
    vec4 row_w;
    uint first; // texel of `depths`
    uint size;  // texels each way; 0: this side of the light is dark, and nothing shades it
    float bias; // of depth: constant, and as a share of depth
    float bias_share;
};

// Sides of a light: +x, -x, +y, -y, +z, -z of a place; one and the same six times for what looks one way.
const uint SHADOW_FACES = 6u;
