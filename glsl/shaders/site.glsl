// Where a fine vertex lies on the base mesh. Include after base_edges and base_triangles are declared.

// A point of the base mesh: three attribute vertices and its barycentrics among them.
struct Site {
    uvec3 av;
    vec3 b;
    // On a smooth base: 8 × the base triangle, + 1 + 2 × side, + 1 against the triangle, of a place on an edge; all bits
    // set at an attribute vertex.
    uint patch_code;
};

// t runs along the ae, so that both sides of a seam blend the same numbers in the same order.
Site edge_site(const uint edge, const float t) {
    BaseEdge base = LOAD(base_edges, edge);
    return Site(base.av.xyy, vec3(1.0 - t, t, 0.0), base.patch_code);
}

// Site of vertex `index` of a block of fine vertices.
Site site_of(const Lattice lattice, const uint block, const uint index) {
    uint n = 1u << lattice.level;
    float step = 1.0 / float(n);
    if (block == CORNERS) {
        return Site(uvec3(index), vec3(1.0, 0.0, 0.0), 0xffffffffu);
    }
    if (block == EDGES) {
        uint edge = index / (n - 1u);
        return edge_site(edge, float(index - edge * (n - 1u) + 1u) * step);
    }
    uint points = interior_points(n);
    uint t = index / points;
    uvec2 ij = interior_point(n, index - t * points);
    return Site(LOAD(base_triangles, t).av, vec3(n - ij.x - ij.y, ij) * step, 8u * t);
}
