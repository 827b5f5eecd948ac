// The regions that a pass of the bound works on: triangles, or lines. Include after bound_facet.glsl.

PAGED(2, readonly, Line, lines);

// Units of the corners among three vertices, a column for each. A line's third corner lies between the others and does
// not count.
struct Region {
    uvec3 av;
    uvec2 layers;
    uvec3 a;
    uvec3 b;
    uvec3 c;
    float least; // length of directions
};

Region region_of(const uint i, const bool of_lines) {
    if (of_lines) {
        Line line = LOAD(lines, i);
        uvec3 along = line.along;
        uvec3 left = WHOLE - along;
        return Region(
            line.av.xyy,
            line.layers,
            uvec3(left.x, along.x, 0u),
            uvec3(left.y, along.y, 0u),
            uvec3(left.z, along.z, 0u),
            0.0
        );
    }
    FacetPlace facet = LOAD(facets, i);
    BoundTriangle triangle = LOAD(bound_triangles, facet.base);
    return Region(
        triangle.av, triangle.layers, units_of(facet.a), units_of(facet.b), units_of(facet.c), triangle.least
    );
}
