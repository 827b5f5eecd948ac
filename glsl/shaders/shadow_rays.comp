#version 460
#extension GL_GOOGLE_include_directive : require
// Which lights are seen from each fragment: a ray to sample k of each as `light_aims` has it, stopped by any opaque
// triangle. A thread per fragment and light. The test of triangles is watertight (Woop, Benthin and Wald 2013): edges belong to both sides, so no ray slips
// through between neighbours.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "bvh.glsl"
#include "raster_tables.glsl"
#include "material.glsl"
#include "vertex_color.glsl"
#include "texel_pair.glsl"
#include "texture_use.glsl"
#include "relief.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // fragments x lights
    uint lights;
    uint k;
    uint nodes;
    uint part_last;
    uint uv_channels;
    uint has_colors;
    float offset_world; // off the surface: more than positions are rounded by
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, vec4, aims); // direction, and how far; 0: nowhere
PAGED(2, readonly, BvhNode, nodes);
PAGED(3, readonly, vec3, occluder_corners); // world, three for each occluder
PAGED(4, readonly, uint, occluders);        // triangle << 1, and whether it is the last of its node
PAGED(5, readonly, Part, parts);
PAGED(6, readonly, uvec3, triangles);
PAGED(7, readonly, Material, materials);
PAGED(8, readonly, vec4, colors);
PAGED(9, readonly, vec2, uvs);
PAGED(10, readonly, TextureUse, maps);
PAGED(11, readonly, uvec4, levels);
PAGED(12, readonly, TexelPair, texels);
PAGED(13, , float, shadows); // as `arriving_of` reads it
PAGED(14, readonly, vec4, instance_rows);
PAGED(15, readonly, Relief, reliefs);
#include "texture.glsl"
#include "relief_leaving.glsl"

// A ray in its own axes: `z` is where it points most, and the others are sheared along it.
struct Sheared {
    vec3 origin;
    ivec3 axes;
    vec3 shear; // x, y, and 1 / direction along z
    float end;
};

struct Crossing {
    bool exists;
    vec3 weights;
};

Sheared sheared(vec3 origin, vec3 direction, float end) {
    vec3 size = abs(direction);
    int z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    ivec3 axes = ivec3((z + 1) % 3, (z + 2) % 3, z);
    float inverse = 1.0 / direction[z];
    return Sheared(origin, axes, vec3(direction[axes.x] * inverse, direction[axes.y] * inverse, inverse), end);
}

vec3 in_ray(Sheared ray, vec3 corner) {
    precise vec3 p = corner - ray.origin;
    precise float x = p[ray.axes.x] - ray.shear.x * p[ray.axes.z];
    precise float y = p[ray.axes.y] - ray.shear.y * p[ray.axes.z];
    return vec3(x, y, ray.shear.z * p[ray.axes.z]);
}

float edge(vec3 a, vec3 b) {
    precise float left = a.x * b.y;
    precise float right = a.y * b.x;
    precise float result = left - right;
    return result;
}

Crossing crossing(Sheared ray, uint first_corner) {
    vec3 a = in_ray(ray, LOAD(occluder_corners, first_corner));
    vec3 b = in_ray(ray, LOAD(occluder_corners, first_corner + 1u));
    vec3 c = in_ray(ray, LOAD(occluder_corners, first_corner + 2u));
    vec3 weights = vec3(edge(c, b), edge(a, c), edge(b, a));
    bool outside = any(lessThan(weights, vec3(0.0))) && any(greaterThan(weights, vec3(0.0)));
    float total = weights.x + weights.y + weights.z;
    if (outside || total == 0.0) {
        return Crossing(false, vec3(0.0));
    }
    weights /= total;
    float t = dot(weights, vec3(a.z, b.z, c.z));
    return Crossing(t > 0.0 && t < ray.end, weights);
}

bool is_opaque(uint id, uint first_corner, vec3 weights, Start start) {
    FIND_PART(id, 0u, params.part_last, part)
    // What heights keep off, marches tell; their triangles are not where they are seen.
    if ((part.flags & PART_RELIEF) != 0u) {
        mat3 corner = mat3(
            LOAD(occluder_corners, first_corner), LOAD(occluder_corners, first_corner + 1u),
            LOAD(occluder_corners, first_corner + 2u));
        if (leaves_relief(start, part, corner, corner * weights)) {
            return false;
        }
    }
    if ((part.flags & (PART_MASKED | PART_BLENDED)) == 0u) {
        return true;
    }
    SurfacePoint point;
    point.vertices = LOAD(triangles, part.triangle_base + (id - part.first_triangle));
    point.at = weights;
    Material m = LOAD(materials, part.material);
    float alpha = m.base_color.a;
    if (params.has_colors != 0u && (part.flags & PART_COLORED) != 0u) {
        alpha *= VERTEX_COLOR(point).a;
    }
    TextureUse map = LOAD(maps, part.material * MAP_SLOTS + MAP_BASE_COLOR);
    if (map.level_count > 0u) {
        mat3x2 corner;
        for (int k = 0; k < 3; ++k) {
            corner[k] = LOAD(uvs, point.vertices[k] * params.uv_channels + map.uv_channel);
        }
        vec2 uv = vec3(corner * weights, 1.0) * mat2x3(map.map_u, map.map_v);
        alpha *= bilinear(LOAD(levels, map.level_first), uv, wraps_of(map)).a;
    }
    return alpha >= m.alpha_cutoff;
}

bool stops(Sheared ray, uint first, Start start) {
    [[dont_unroll]] for (uint k = 0u; k < 256u; ++k) {
        uint occluder = LOAD(occluders, first + k);
        Crossing found = crossing(ray, (first + k) * 3u);
        if (found.exists && is_opaque(occluder >> 1, (first + k) * 3u, found.weights, start)) {
            return true;
        }
        if ((occluder & 1u) != 0u) {
            break;
        }
    }
    return false;
}

bool meets(BvhNode node, vec3 origin, vec3 inverse, float end) {
    vec3 a = (node.low - origin) * inverse;
    vec3 b = (node.high - origin) * inverse;
    vec3 near = min(a, b);
    vec3 far = max(a, b);
    float enter = max(max(near.x, near.y), max(near.z, 0.0));
    float leave = min(min(far.x, far.y), min(far.z, end)) * BVH_SLACK;
    return enter <= leave;
}

// Nodes lie in the order of a walk: into a node is the next, past it is `skip`.
bool is_stopped(vec3 origin, float end, Start start) {
    vec3 direction = start.direction;
    Sheared ray = sheared(origin, direction, end);
    // Along a plane of a box, 0 times infinity would be no number.
    vec3 inverse = mix(vec3(1.0), vec3(-1.0), lessThan(direction, vec3(0.0))) / max(abs(direction), vec3(1e-20));
    uint n = 0u;
    [[dont_unroll]] for (uint step = 0u; step < params.nodes && n < params.nodes; ++step) {
        BvhNode node = LOAD(nodes, n);
        bool met = meets(node, origin, inverse, end);
        if (met && node.first != BVH_INNER && stops(ray, node.first, start)) {
            return true;
        }
        n = met ? n + 1u : node.skip;
    }
    return false;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i / params.lights);
    vec4 aim = LOAD(aims, i);
    vec3 origin = point.position + point.facing * params.offset_world;
    Start start = Start(point.position, aim.xyz, point.normal, point.instance, point.material);
    if (aim.w > 0.0 && !is_stopped(origin, aim.w, start)) {
        float seen = LOAD(shadows, i);
        STORE(shadows, i, seen < 0.0 ? seen - float(1u << params.k) : 1.0);
    }
}

#include "batch.glsl"
