#version 460
// The way of each fragment's ray over the quadric where it strikes its raised triangle, over the material's height map. A
// thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "raster_tables.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"
#include "relief.glsl"
#include "geometry_quadric.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform CourseParams {
    uint count;
    uint uv_channels;
} params;

PAGED(0, readonly, Fragment, fragments);
PAGED(1, readonly, SurfacePoint, points);
PAGED(2, readonly, vec4, instance_rows);
PAGED(3, readonly, vec3, positions);
PAGED(4, readonly, vec3, directions);
PAGED(5, readonly, vec2, uvs);
PAGED(6, readonly, Relief, reliefs);
PAGED(7, readonly, ReliefLevel, relief_levels);
// Of vertices: xx, xy, xz and yy, yz, zz of how the surface bends, two for each.
PAGED(8, readonly, vec3, bends);
// Of instances: by how much their triangles are raised, mesh-local units.
PAGED(9, readonly, float, raises);
PAGED(10, , Course, courses); // levels are there
PAGED(11, writeonly, vec4, course_nodes);

#include "pixel_ray.glsl"
#include "course_texels.glsl"

vec3 unit_direction(uint vertex) {
    vec3 direction = LOAD(directions, vertex);
    float size = length(direction);
    return size > 0.0 ? direction / size : vec3(0.0);
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Relief relief = LOAD(reliefs, point.material);
    uint level = LOAD(courses, i).level;
    STORE(courses, i, Course(0u, point.material, level, 0.0, 0u));
    if (relief.level_count == 0u) {
        return;
    }
    mat3 corner;
    mat3 along;
    Bends bend;
    for (int k = 0; k < 3; ++k) {
        corner[k] = LOAD(positions, point.vertices[k]);
        along[k] = unit_direction(point.vertices[k]);
        bend.first[k] = LOAD(bends, 2u * point.vertices[k]);
        bend.second[k] = LOAD(bends, 2u * point.vertices[k] + 1u);
    }
    mat3x2 texels = texels_of(relief, point.vertices, level);
    Prism prism = prism_of(corner, along, vec2(relief.low, relief.high));
    if (prism.side <= 0.0) {
        return;
    }
    PixelRay ray = pixel_ray(point.instance * INSTANCE_ROWS, LOAD(fragments, i).at_px, corner[0]);
    // Directions of a prism are unit where those of its corners are.
    float raise = LOAD(raises, point.instance) / prism.side;
    Flight flight = strike_of(prism, bend, raise, ray.origin / prism.side, ray.direction / prism.side);
    float time = time_of(prism, flight);
    if (time <= 0.0 || flight.t < ray.least) {
        return;
    }
    [[dont_unroll]] for (uint n = 0u; n < COURSE_NODES; ++n) {
        float t = time * (float(n) / float(COURSE_NODES - 1u));
        vec4 at = flight_at(flight, t);
        STORE(course_nodes, i * COURSE_NODES + n, vec4(texels * at.xyz, at.w * prism.side, flight.t + t));
    }
    STORE(courses, i, Course(COURSE_NODES, point.material, level, abs(dot(ray.direction, prism.upright)), 0u));
}

#include "batch.glsl"
