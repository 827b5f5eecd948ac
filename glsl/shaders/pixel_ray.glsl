// The ray through a place of the image, mesh-local, by the rows of an instance: where it passes a point nearest, so that
// nothing is lost to how far the viewer is. Needs `instance_rows`. Twin: reference/relief/pixel_ray.rs.

struct PixelRay {
    vec3 origin;    // from the point, mesh-local, at right angles to the direction
    vec3 direction; // unit, away from the viewer
    float least;    // distance along it where what is before the viewer begins
};

PixelRay pixel_ray(uint row, vec2 at_px, vec3 point) {
    vec4 w = LOAD(instance_rows, row + 3u);
    vec4 z = LOAD(instance_rows, row + 2u);
    // Two planes that the ray lies in.
    vec4 a = LOAD(instance_rows, row) - at_px.x * w;
    vec4 b = LOAD(instance_rows, row + 1u) - at_px.y * w;
    vec4 at = vec4(point, 1.0);
    vec3 along = cross(a.xyz, b.xyz);
    float largest = max(max(abs(along.x), abs(along.y)), abs(along.z));
    vec3 across = (-dot(a, at) * cross(b.xyz, along / largest) - dot(b, at) * cross(along / largest, a.xyz)) / largest;
    along /= largest;
    float squared = dot(along, along);
    // How z/w changes along the ray, times w squared: it falls away from the viewer.
    float change = dot(z.xyz, along) * dot(w, at) - dot(z, at) * dot(w.xyz, along);
    PixelRay ray;
    ray.direction = along * ((change > 0.0 ? -1.0 : 1.0) * inversesqrt(squared));
    ray.origin = across / squared;
    // z/w is 1 nearest to the viewer.
    vec4 before = z - w;
    float rate = dot(before.xyz, ray.direction);
    ray.least = rate < 0.0 ? -(dot(before, at) + dot(before.xyz, ray.origin)) / rate : -3e38;
    return ray;
}
