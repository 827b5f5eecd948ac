// From homogeneous pixels to 24.8 fixed point, and the planes a vertex lies outside of.

// Fixed-point units of one pixel.
const int SUBPIXELS = 256;
// Vertices farther out than this are clipped, so that fixed-point coordinates fit 24 bits.
const float GUARD_PX = 32767.0;

const uint OUTSIDE_LEFT = 1u;
const uint OUTSIDE_RIGHT = 2u;
const uint OUTSIDE_TOP = 4u;
const uint OUTSIDE_BOTTOM = 8u;
const uint OUTSIDE_NEAR = 16u;
const uint OUTSIDE_FAR = 32u;
const uint OUTSIDE_ANY = 63u;
// The vertex cannot be projected, or lands outside the guard band.
const uint NEEDS_CLIP = 64u;
// Not finite: its triangles are dropped.
const uint NOT_FINITE = 128u;

uint outside_planes(vec4 h, vec2 size_px) {
    uint flags = h.x < 0.0 ? OUTSIDE_LEFT : 0u;
    flags |= h.x > size_px.x * h.w ? OUTSIDE_RIGHT : 0u;
    flags |= h.y < 0.0 ? OUTSIDE_TOP : 0u;
    flags |= h.y > size_px.y * h.w ? OUTSIDE_BOTTOM : 0u;
    flags |= h.z > h.w ? OUTSIDE_NEAR : 0u;
    flags |= h.z < 0.0 ? OUTSIDE_FAR : 0u;
    return flags;
}

// (x, y) in fixed point and the bits of the reversed depth; w of `h` is positive.
ivec3 snapped(vec4 h) {
    precise vec2 pixel = h.xy / h.w;
    precise float depth = clamp(h.z / h.w, 0.0, 1.0);
    return ivec3(ivec2(roundEven(pixel * float(SUBPIXELS))), floatBitsToInt(depth));
}

// A record of `screen`: fixed-point x and y, depth bits, flags.
ivec4 screen_vertex(vec4 h, vec2 size_px) {
    if (!all(lessThan(abs(h), vec4(1e30)))) {
        return ivec4(0, 0, 0, int(NOT_FINITE));
    }
    uint flags = outside_planes(h, size_px);
    bool projects = h.w > 0.0 && (flags & (OUTSIDE_NEAR | OUTSIDE_FAR)) == 0u;
    if (!projects || any(greaterThan(abs(h.xy), vec2(GUARD_PX * h.w)))) {
        return ivec4(0, 0, 0, int(flags | NEEDS_CLIP));
    }
    return ivec4(snapped(h), int(flags));
}
