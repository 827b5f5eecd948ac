// Where the samples lie, and which edges own the points on them.
//
// The four samples of a pixel are the standard rotated grid at (96, 32), (224, 96), (32, 160), (160, 224)
// of 256: every row of 64 units holds exactly one sample per pixel, so sample s of a pixel is the one in
// its row s.

int sample_x(int s) {
    return ((0xA020E060 >> (s * 8)) & 0xFF);
}

int sample_y(int s) {
    return 32 + 64 * s;
}

// First and last sample row (pixel row * 4 + sample) within [low, high] of fixed-point y.
int first_row(int low) {
    return (low + 31) >> 6;
}

int last_row(int high) {
    return (high - 32) >> 6;
}

// First and last pixel whose sample at offset `x` lies within [low, high] of fixed-point x.
int first_pixel(int low, int x) {
    return (low - x + 255) >> 8;
}

int last_pixel(int high, int x) {
    return (high - x) >> 8;
}

// Points on an edge belong to the triangle whose top or left edge it is. Triangles run clockwise on the
// screen (y down), where the edge function is positive inside.
int edge_bias(ivec2 edge) {
    return edge.y < 0 || (edge.y == 0 && edge.x > 0) ? 0 : -1;
}
