// Which base triangles of relief keep no light off. Include after raster_tables.glsl and relief.glsl; needs `instance_rows`
// and `reliefs` in scope. Twin: reference/relief/leaving.rs.

// Where a ray begins.
struct Start {
    vec3 position; // world
    vec3 direction; // unit
    vec3 normal;    // of the base there, world, unit
    uint instance;
    uint material;
};

// Whether a ray through the front of a base triangle, at `crossing`, only comes out of what its heights lie in: from no
// farther behind it than they are deep, or from its own base, above which it has risen by no more than twice that: triangles bend away below it.
bool leaves_relief(Start start, Part part, mat3 corner, vec3 crossing) {
    vec3 a = corner[1] - corner[0];
    vec3 b = corner[2] - corner[0];
    vec3 across = cross(a, b);
    float area = length(across);
    if (area == 0.0) {
        return true;
    }
    vec3 front = across * (((part.flags & PART_MIRRORED) != 0u ? -1.0 : 1.0) / area);
    if (dot(start.direction, front) <= 0.0) {
        return false;
    }
    Relief relief = LOAD(reliefs, part.material);
    uint row = part.instance * INSTANCE_ROWS + WORLD_ROW;
    // What a height of 1 rises above the triangle.
    float unit = length(
        front.x * LOAD(instance_rows, row).xyz + front.y * LOAD(instance_rows, row + 1u).xyz +
        front.z * LOAD(instance_rows, row + 2u).xyz);
    float side = sqrt(max(max(dot(a, a), dot(b, b)), dot(b - a, b - a)));
    float margin = max((relief.high - relief.low) * unit / 64.0, side / 4096.0);
    float deepest = max(-relief.low, 0.0) * unit + margin;
    if (dot(corner[0] - start.position, front) <= deepest) {
        return true;
    }
    bool is_own = start.instance == part.instance && start.material == part.material;
    float rise = dot(crossing - start.position, start.normal);
    return is_own && rise > 0.0 && rise <= 2.0 * deepest;
}
