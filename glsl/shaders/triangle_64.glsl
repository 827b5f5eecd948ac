// A triangle of a record: corners within the guard band, so edge functions take 51 bits.
// Needs `records` in scope.

struct Triangle64 {
    uint id;
    ivec2 corner[3];
    ivec2 edge[3]; // edge k is opposite corner k
    vec3 depth;
};

Triangle64 load_record(uint record) {
    ivec4 a = LOAD(records, record * 3u);
    ivec4 b = LOAD(records, record * 3u + 1u);
    ivec4 c = LOAD(records, record * 3u + 2u);
    Triangle64 t;
    t.id = uint(a.w);
    t.corner = ivec2[3](a.xy, b.xy, c.xy);
    t.edge = ivec2[3](c.xy - b.xy, a.xy - c.xy, b.xy - a.xy);
    t.depth = intBitsToFloat(ivec3(a.z, b.z, c.z));
    return t;
}

// Edge function k at a point: non-negative inside.
int64_t edge_at(Triangle64 t, int k, ivec2 p) {
    ivec2 from = t.corner[(k + 1) % 3];
    return int64_t(t.edge[k].x) * int64_t(p.y - from.y) - int64_t(t.edge[k].y) * int64_t(p.x - from.x);
}
