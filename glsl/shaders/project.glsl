// Homogeneous pixels of a place in a mesh. Needs `instance_rows` in scope. Every pass that projects a vertex
// does it here: the same bits come out.

vec4 homogeneous(uint instance, vec3 p) {
    vec4 h;
    for (uint k = 0u; k < 4u; ++k) {
        vec4 row = LOAD(instance_rows, instance * INSTANCE_ROWS + k);
        precise float sum = row.x * p.x + row.y * p.y + row.z * p.z + row.w;
        h[k] = sum;
    }
    return h;
}
