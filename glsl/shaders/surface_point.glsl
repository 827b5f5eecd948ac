// What is under a fragment. Mirrored in layout.rs.
struct SurfacePoint {
    uint id;        // triangle
    uint material;
    uint covered;   // a bit for each sample, or depth bits of a sample under test
    uint instance;
    uint triangle;  // in the stream of all meshes' triangles
    uvec3 vertices;
    vec3 at;        // weights of the vertices
    vec3 at_dx;     // per pixel
    vec3 at_dy;
    vec3 position;  // world
    vec3 normal;    // world, interpolated and made unit, towards the viewer's side; zero where there is none
    vec3 facing;    // world, of the triangle, towards the viewer; zero where it has no area
    float flip;     // -1 where the back is seen, 1 elsewhere
    uint pixel;     // column, and row << 16
};
