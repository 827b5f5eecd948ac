#version 460
#extension GL_GOOGLE_include_directive : require
// What each fragment looks like: factors, vertex colours and the values of maps in one (glTF 2.0, 3.9). A thread per
// fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "raster_tables.glsl"
#include "material.glsl"
#include "appearance.glsl"
#include "vertex_color.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint maps; // slots that have any map, a bit each: streams of the others are empty
    uint has_colors;
    uint is_projected; // values of normal maps are slopes in the mesh's space
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Material, materials);
PAGED(2, readonly, vec4, colors);
PAGED(3, readonly, vec4, tangents); // of corners, three for each triangle; w: handedness, 0: none
PAGED(4, readonly, vec4, instance_rows);
PAGED(5, readonly, vec4, mapped_base_color);
PAGED(6, readonly, vec4, mapped_normal);
PAGED(7, readonly, vec4, mapped_metallic_roughness);
PAGED(8, readonly, vec4, mapped_occlusion);
PAGED(9, readonly, vec4, mapped_emissive);
PAGED(10, writeonly, Appearance, appearances);

const uint HAS_BASE_COLOR = 1u;
const uint HAS_NORMAL = 2u;
const uint HAS_METALLIC_ROUGHNESS = 4u;
const uint HAS_OCCLUSION = 8u;
const uint HAS_EMISSIVE = 16u;

#include "mapped_direction.glsl"

// The normal of a surface that is tilted by a slope in the mesh's space, which stays as steep in the world (surface
// gradients, Mikkelsen 2020).
vec3 tilted(SurfacePoint point, vec3 tilt) {
    uint row = point.instance * INSTANCE_ROWS + WORLD_ROW;
    vec3 t;
    for (uint k = 0u; k < 3u; ++k) {
        t[k] = dot(LOAD(instance_rows, row + k).xyz, tilt);
    }
    float length_squared = dot(t, t);
    t *= length_squared > 1e-30 ? length(tilt) * inversesqrt(length_squared) : 0.0;
    vec3 front = point.normal * point.flip;
    vec3 direction = front + t - front * dot(front, t);
    return point.normal == vec3(0.0) ? point.normal : point.flip * normalize(direction);
}

vec3 shading_normal(SurfacePoint point, Material m, uint i) {
    if (params.is_projected != 0u) {
        return tilted(point, m.normal_scale * LOAD(mapped_normal, i).xyz);
    }
    vec3 n = LOAD(mapped_normal, i).xyz * vec3(m.normal_scale, m.normal_scale, 1.0);
    vec3 direction = mapped_direction(point, n);
    float length_squared = dot(direction, direction);
    return length_squared > 1e-20 ? direction * inversesqrt(length_squared) : point.normal;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Material m = LOAD(materials, point.material);
    Appearance a = Appearance(m.base_color, m.emissive, m.metallic, point.normal, m.roughness, 1.0, m.flags);
    if (params.has_colors != 0u) {
        a.base *= VERTEX_COLOR(point);
    }
    if ((params.maps & HAS_BASE_COLOR) != 0u) {
        a.base *= LOAD(mapped_base_color, i);
    }
    if ((params.maps & HAS_NORMAL) != 0u && (m.flags & MATERIAL_NORMAL_MAP) != 0u) {
        a.normal = shading_normal(point, m, i);
    }
    if ((params.maps & HAS_METALLIC_ROUGHNESS) != 0u) {
        vec4 value = LOAD(mapped_metallic_roughness, i);
        a.roughness *= value.g;
        a.metallic *= value.b;
    }
    if ((params.maps & HAS_OCCLUSION) != 0u) {
        a.occlusion = 1.0 + m.occlusion_strength * (LOAD(mapped_occlusion, i).r - 1.0);
    }
    if ((params.maps & HAS_EMISSIVE) != 0u) {
        a.emissive *= LOAD(mapped_emissive, i).rgb;
    }
    STORE(appearances, i, a);
}

#include "batch.glsl"
