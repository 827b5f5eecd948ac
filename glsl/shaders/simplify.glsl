// A refined mesh while it is simplified. The twins are `reference/collapse.rs` and `reference/flip.rs`; structs are
// mirrored in layout/simplify.rs. Include after common.glsl, pages.glsl and refine.glsl.

#include "facet.glsl"

// A base ge: its gvs, and how many base triangles have it.
struct Sheets {
    uvec2 gv;
    uint count;
};

// More triangles than this around a vertex, and it stays.
const uint MOST_AROUND = 64u;

PAGED(0, readonly, Facet, triangles);
PAGED(1, readonly, uint, star_first); // of each vertex in star_items, and one more
PAGED(2, readonly, uint, star_items); // triangles around, in no order: whatever is made of them has none

Facet facet_of(const uint t) {
    return LOAD(triangles, t);
}

bool has(const Facet facet, const uint vertex) {
    return any(equal(facet.gv, uvec3(vertex)));
}

Facet moved(const Facet facet, const uint vertex, const uint to) {
    return Facet(mix(facet.gv, uvec3(to), equal(facet.gv, uvec3(vertex))), facet.base);
}
