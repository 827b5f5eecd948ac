// A triangle whose box is at most 64 pixels wide: all of its edge functions fit 32 bits.
// Coordinates are relative to `origin`, the low corner of the box. Needs triangles, parts and screen in scope.

struct Triangle32 {
    ivec2 origin;
    ivec2 high;     // absolute high corner of the box
    ivec2 corner[3];
    ivec2 edge[3];  // edge k is opposite corner k
    ivec3 bias;
    float depth;    // at corner 0
    vec2 slope;     // depth per edge function 1 and 2
    vec2 depth_range;
};

Triangle32 load_triangle(uint id) {
    FIND_PART(id, params.part_first, params.part_last, part)
    uvec3 v = LOAD(triangles, part.triangle_base + (id - part.first_triangle)) + part.screen_base;
    ivec4 a = LOAD(screen, v.x);
    ivec4 b = LOAD(screen, v.y);
    ivec4 c = LOAD(screen, v.z);
    ivec2 ab = b.xy - a.xy;
    ivec2 ac = c.xy - a.xy;
    int area = ab.x * ac.y - ab.y * ac.x;
    if (area < 0) {
        ivec4 swapped = b;
        b = c;
        c = swapped;
        area = -area;
    }
    Triangle32 t;
    t.origin = min(min(a.xy, b.xy), c.xy);
    t.high = max(max(a.xy, b.xy), c.xy);
    t.corner = ivec2[3](a.xy - t.origin, b.xy - t.origin, c.xy - t.origin);
    t.edge = ivec2[3](c.xy - b.xy, a.xy - c.xy, b.xy - a.xy);
    t.bias = ivec3(edge_bias(t.edge[0]), edge_bias(t.edge[1]), edge_bias(t.edge[2]));
    vec3 depth = intBitsToFloat(ivec3(a.z, b.z, c.z));
    t.depth = depth.x;
    t.slope = (depth.yz - depth.x) / float(area);
    t.depth_range = vec2(min(min(depth.x, depth.y), depth.z), max(max(depth.x, depth.y), depth.z));
    return t;
}

// The edge functions at a point relative to the origin: non-negative inside.
ivec3 edges_at(Triangle32 t, ivec2 p) {
    ivec2 p0 = p - t.corner[1];
    ivec2 p1 = p - t.corner[2];
    ivec2 p2 = p - t.corner[0];
    return ivec3(
        t.edge[0].x * p0.y - t.edge[0].y * p0.x,
        t.edge[1].x * p1.y - t.edge[1].y * p1.x,
        t.edge[2].x * p2.y - t.edge[2].y * p2.x);
}

bool is_inside(ivec3 edges, ivec3 bias) {
    ivec3 biased = edges + bias;
    return (biased.x | biased.y | biased.z) >= 0;
}

float depth_at(Triangle32 t, ivec3 edges) {
    precise float depth = t.depth + (float(edges.y) * t.slope.x + float(edges.z) * t.slope.y);
    return clamp(depth, t.depth_range.x, t.depth_range.y);
}
