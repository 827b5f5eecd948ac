// The numbering of a uniformly subdivided mesh; `lattice.rs` is the same in Rust. Include after common.glsl.

// n = 2^level segments per edge. Fine vertices: corners (base avs), n − 1 per base ae, then the inside.
struct Lattice {
    uint level;
    uint corners;
    uint edges;
};

// Which block of fine vertices a dispatch works on.
const uint CORNERS = 0u;
const uint EDGES = 1u;
const uint INTERIORS = 2u;

// A base triangle: `ae[k]` joins `av[k]` and `av[(k + 1) % 3]`; bit k of `reversed` is set where the
// ae runs against the triangle.
struct BaseTriangle {
    uvec3 av;
    uvec3 ae;
    uint reversed;
    uint detail;
};

// A base attribute edge, running from the geometric vertex of lower id to the other.
struct BaseEdge {
    uvec2 av;
    uint detail;
    uint patch_code; // where it lies on a smooth base
};

// Fine vertices inside one base triangle; 0 for n of 1 and 2.
uint interior_points(const uint n) {
    return (n - 1u) * (n - 2u) / 2u;
}

// Rank of (i, j), i, j >= 1, i + j < n: rows of constant j in rising i.
uint interior_rank(const uint n, const uint i, const uint j) {
    return (j - 1u) * (n - 1u) - (j - 1u) * j / 2u + (i - 1u);
}

// The inverse of interior_rank: a square root, then exact steps.
uvec2 interior_point(const uint n, const uint rank) {
    uint m = 2u * n - 3u;
    // Roots may be one unit in the last place high: m itself would come out above m.
    uint root = min(uint(integer(ceil(sqrt(float(int(m * m - 8u * rank)))))), m);
    uint k = (m - root) / 2u;
    uint first = k * (m - k) / 2u;
    if (first > rank) {
        k -= 1u;
        first = k * (m - k) / 2u;
    }
    uint next = (k + 1u) * (m - k - 1u) / 2u;
    if (next <= rank) {
        k += 1u;
        first = next;
    }
    return uvec2(rank - first + 1u, k + 1u);
}

// Fine vertex number of lattice point (i, j) of base triangle t: barycentrics (n − i − j, i, j) / n.
uint fine_vertex(const Lattice lattice, const BaseTriangle triangle, const uint t, const uint i, const uint j) {
    uint n = 1u << lattice.level;
    uint k = n - i - j;
    if (i > 0u && j > 0u && k > 0u) {
        uint interiors = lattice.corners + lattice.edges * (n - 1u);
        return interiors + t * interior_points(n) + interior_rank(n, i, j);
    }
    if (i == n || j == n || k == n) {
        return i == n ? triangle.av.y : (j == n ? triangle.av.z : triangle.av.x);
    }
    uint side = j == 0u ? 0u : (k == 0u ? 1u : 2u);
    uint along = side == 0u ? i : (side == 1u ? j : k);
    uint edge = side == 0u ? triangle.ae.x : (side == 1u ? triangle.ae.y : triangle.ae.z);
    along = (triangle.reversed >> side & 1u) == 0u ? along : n - along;
    return lattice.corners + edge * (n - 1u) + along - 1u;
}
