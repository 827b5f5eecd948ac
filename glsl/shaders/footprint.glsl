// How much of the surroundings a pixel's mirror image covers. Include after surface_point.glsl and world.glsl; needs
// `positions` and `normals` in scope.

// Where a surface is seen from.
struct View {
    vec3 towards;   // unit, to the viewer
    float nearness; // 1 / distance; 0 from infinitely far away
};

// `eye`: w = 1 a place, w = 0 the direction towards an orthographic camera.
View view_of(vec4 eye, vec3 position) {
    vec3 way = eye.xyz - eye.w * position;
    float nearness = inversesqrt(dot(way, way));
    return View(way * nearness, eye.w * nearness);
}

// Change of the mirrored direction r = 2 (n.v) n - v when n and v change.
vec3 mirrored_change(vec3 n, vec3 v, vec3 dn, vec3 dv) {
    return 2.0 * ((dot(dn, v) + dot(n, dv)) * n + dot(n, v) * dn) - dv;
}

// Radians that r moves by from this pixel to the next, whichever way it moves more: by the curvature of the vertices'
// normals (none where `flat_shaded`) and by the view's own spread.
float mirrored_footprint(SurfacePoint point, vec3 n, View view, bool flat_shaded) {
    mat3 position;
    mat3 normal;
    for (int k = 0; k < 3; ++k) {
        position[k] = LOAD(positions, point.vertices[k]);
        normal[k] = LOAD(normals, point.vertices[k]);
    }
    uint row = point.instance * INSTANCE_ROWS;
    vec3 across = mapped(row + NORMAL_ROW, vec4(normal * point.at, 0.0));
    float squared = dot(across, across);
    float curved = flat_shaded || squared < 1e-30 ? 0.0 : point.flip * inversesqrt(squared);
    float most = 0.0;
    [[dont_unroll]] for (int axis = 0; axis < 2; ++axis) {
        vec3 at = axis == 0 ? point.at_dx : point.at_dy;
        vec3 dn = curved * mapped(row + NORMAL_ROW, vec4(normal * at, 0.0));
        vec3 step = mapped(row + WORLD_ROW, vec4(position * at, 0.0));
        dn -= dot(dn, point.normal) * point.normal;
        vec3 dv = -view.nearness * (step - dot(step, view.towards) * view.towards);
        vec3 change = mirrored_change(n, view.towards, dn, dv);
        most = max(most, dot(change, change));
    }
    return sqrt(most);
}
