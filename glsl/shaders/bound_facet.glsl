// The triangles that are bounded, and the base triangles they lie in. Include after bound.glsl.

PAGED(0, readonly, FacetPlace, facets);
PAGED(1, readonly, BoundTriangle, bound_triangles);

uvec3 units_of(const uvec2 b) {
    return uvec3(WHOLE - b.x - b.y, b);
}

// The sides whose ramp reaches a triangle with these corners. Side k lies opposite corner k + 2.
bvec3 reached(const Ramps sides, const uvec3 a, const uvec3 b, const uvec3 c) {
    precise vec3 across = vec3(min(a, min(b, c)).zxy) * SHARE * sides.inverse_width;
    return lessThan(across, vec3(1.0));
}
