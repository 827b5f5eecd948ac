// What the surface is like under a fragment. Mirrored in layout.rs.
struct SurfacePoint {
    uint id;       // triangle
    uint material;
    uint covered;  // samples, or depth bits of a sample under test
    vec3 position; // world
    vec3 normal;   // world, towards the viewer's side; zero where there is none
    vec2 uv;       // as the mesh has it
    vec2 uv_dx;    // per pixel
    vec2 uv_dy;
};
