// What a new triangle of a simplified mesh has to be, besides near the surface. Include after simplify.glsl, with 64-bit
// integers.

PAGED(3, readonly, RefinedVertex, vertices);
PAGED(4, readonly, RefineBase, bases);
PAGED(5, readonly, vec3, positions); // displaced, by vertex
PAGED(6, readonly, vec3, facing);    // of base triangles

// A triangle that faces away from its base may turn so far: half its old direction.
const float LEAST_TURN = 0.5;

RefinedVertex vertex_of(const uint vertex) {
    return LOAD(vertices, vertex);
}

RefineBase base_of(const uint base) {
    return LOAD(bases, base);
}

vec3 position_of(const uint vertex) {
    return LOAD(positions, vertex);
}

// Twice the area, in square units of the base triangle; above 0 where it runs the same way.
int64_t twice_area(const uvec3 a, const uvec3 b, const uvec3 c) {
    ivec2 to_b = ivec2(b.yz) - ivec2(a.yz);
    ivec2 to_c = ivec2(c.yz) - ivec2(a.yz);
    return int64_t(to_b.x) * int64_t(to_c.y) - int64_t(to_b.y) * int64_t(to_c.x);
}

vec3 normal_of(const Facet facet) {
    vec3 from = position_of(facet.gv.x);
    return cross(position_of(facet.gv.y) - from, position_of(facet.gv.z) - from);
}

// A new triangle faces as its base does, or nearly as the old one did.
bool faces_as(const Facet before, const Facet after) {
    vec3 new = normal_of(after);
    if (dot(new, LOAD(facing, after.base)) > 0.0) {
        return true;
    }
    vec3 old = normal_of(before);
    return dot(new, old) > LEAST_TURN * length(new) * length(old);
}
