// The side between two triangles of one base triangle, and what it would be turned into: of triangle abc with side ab and
// the one across with d, triangles cad and dbc. Include after common.glsl.

struct Flip {
    uint other; // triangle across, or NOWHERE
    uint d;
};

// A flip that gains less, as a share of the tolerance, is left alone: it could be turned back for ever.
const float LEAST_GAIN = 1e-3;

uvec3 turned(const uvec3 gv, const uint side) {
    return side == 0u ? gv : (side == 1u ? gv.yzx : gv.zxy);
}

// From abc, in two triangles.
uvec3 first_after(const uvec3 abc, const uint d) {
    return uvec3(abc.z, abc.x, d);
}

uvec3 second_after(const uvec3 abc, const uint d) {
    return uvec3(d, abc.y, abc.z);
}
