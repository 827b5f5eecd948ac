// A place on a triangle that is to be shaded or tested. Mirrored in layout.rs.
struct Fragment {
    uint id;     // triangle
    vec2 at_px;  // in the image
    uint extra;  // depth bits of a sample under test; a bit for each sample covered otherwise
};
