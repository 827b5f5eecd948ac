// The mesh while it is refined: places, edges and triangles over a base mesh. Every number is whole: barycentrics and
// places along edges count units of 2^-24, so that halving them is exact. Mirrored in layout/refine.rs.

const uint UNIT = 1u << 24;
const uint CORNER = 0u;   // owner: base gv
const uint EDGE = 1u;     // owner: base ge
const uint INTERIOR = 2u; // owner: base triangle

// A geometric vertex. On an edge param.x counts from the ge's first gv; inside, param is b1 and b2.
struct RefinedVertex {
    uint kind;
    uint owner;
    uvec2 param;
};

// A geometric edge: of a base ge (kind EDGE), or inside one base triangle (kind INTERIOR).
struct RefinedEdge {
    uvec2 gv;
    float length_square; // on the flat base, local units
    uint kind;
    uint owner;
    uint key; // see keys.glsl
};

// Edge k joins vertices k and k + 1.
struct RefinedTriangle {
    uvec3 gv;
    uvec3 ge;
    uint base;
};

// A base triangle. Bit k of reversed: its ge k runs from corner k + 1 to corner k.
struct RefineBase {
    uvec3 gv;
    uvec3 ge;
    uint reversed;
};

// Where a vertex lies in a base triangle that has it, in units.
uvec3 barycentrics(const RefinedVertex vertex, const RefineBase base) {
    if (vertex.kind == INTERIOR) {
        return uvec3(UNIT - vertex.param.x - vertex.param.y, vertex.param);
    }
    if (vertex.kind == CORNER) {
        return uvec3(equal(base.gv, uvec3(vertex.owner))) * UNIT;
    }
    uint side = base.ge.x == vertex.owner ? 0u : (base.ge.y == vertex.owner ? 1u : 2u);
    uint along = (base.reversed >> side & 1u) == 1u ? UNIT - vertex.param.x : vertex.param.x;
    uvec3 from = uvec3(UNIT - along, along, 0u);
    return side == 0u ? from : (side == 1u ? from.zxy : from.yzx);
}

// How far along the base ge with this first gv.
uint along_edge(const RefinedVertex vertex, const uint first_gv) {
    return vertex.kind == CORNER ? (vertex.owner == first_gv ? 0u : UNIT) : vertex.param.x;
}

// The side to split first: longer before shorter, then by keys, which are mixed, since along a ribbon numbers rise and
// every triangle would wait for the next. Sides have an order of their own, so all triangles of an edge agree on it.
bool is_longer(const RefinedEdge a, const RefinedEdge b) {
    uint x = floatBitsToUint(a.length_square);
    uint y = floatBitsToUint(b.length_square);
    return x > y || (x == y && a.key > b.key);
}

// Which of three sides.
uint longest_of(const RefinedEdge a, const RefinedEdge b, const RefinedEdge c) {
    if (is_longer(b, a)) {
        return is_longer(c, b) ? 2u : 1u;
    }
    return is_longer(c, a) ? 2u : 0u;
}
