#version 460
#extension GL_GOOGLE_include_directive : require
// Normals bent by what materials have besides their own normal map: slopes of heights, and further normal maps. All are
// surface gradients and add (Mikkelsen 2010, 2020). A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "raster_tables.glsl"
#include "appearance.glsl"
#include "texture_use.glsl"
#include "bump.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint maps;        // detail slots that have any map, a bit each from the first on: streams of the others are empty
    uint uv_channels; // of each vertex
    uint has_tangents;
    uint has_rises;
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, vec3, positions);
PAGED(2, readonly, vec3, normals);
PAGED(3, readonly, vec2, uvs);
PAGED(4, readonly, vec4, tangents); // of corners, three for each triangle; w: handedness, 0: none
PAGED(5, readonly, vec4, instance_rows);
PAGED(6, readonly, TextureUse, maps);
PAGED(7, readonly, Bump, bumps);
PAGED(8, readonly, vec4, mapped_detail_0);
PAGED(9, readonly, vec4, mapped_detail_1);
PAGED(10, readonly, vec4, mapped_detail_2);
PAGED(11, readonly, vec4, mapped_detail_3);
PAGED(12, readonly, vec2, rises); // of formulas
PAGED(13, , Appearance, appearances);
#include "world.glsl"

// A triangle, and the normal that is bent.
struct Place {
    vec3 side_1; // mesh-local, from the first vertex to the second
    vec3 side_2;
    vec3 normal; // mesh-local, unit
    vec3 front;  // the same in the world, on the side of the front
    uint row;    // of the instance
};

vec4 value_of(uint slot, uint i) {
    switch (slot) {
    case 0u:
        return LOAD(mapped_detail_0, i);
    case 1u:
        return LOAD(mapped_detail_1, i);
    case 2u:
        return LOAD(mapped_detail_2, i);
    default:
        return LOAD(mapped_detail_3, i);
    }
}

// Changes of u and v of a map along a side, in the columns.
mat2 map_changes(SurfacePoint point, TextureUse map) {
    vec2 corner[3];
    for (uint k = 0u; k < 3u; ++k) {
        corner[k] = LOAD(uvs, point.vertices[k] * params.uv_channels + map.uv_channel);
    }
    mat2 of_uv = mat2(corner[1] - corner[0], corner[2] - corner[0]);
    return mat2(map.map_u.x, map.map_v.x, map.map_u.y, map.map_v.y) * of_uv;
}

// Along the tangent and bitangent of MikkTSpace, which are interpolated, not made orthogonal to the normal.
vec3 in_mikktspace(SurfacePoint point, Place place, vec2 lean) {
    if (params.has_tangents == 0u) {
        return vec3(0.0);
    }
    vec4 tangent = vec4(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        tangent += LOAD(tangents, point.triangle * 3u + k) * point.at[k];
    }
    vec3 t = unit_or_zero(mapped(place.row + WORLD_ROW, vec4(tangent.xyz, 0.0)));
    return tangent.w == 0.0 ? vec3(0.0) : lean.x * t + lean.y * (sign(tangent.w) * cross(place.front, t));
}

// As CySlice's shader prints it: the S tangent is dPdu Dv(t) - dPdv Du(t), of which the sign of the UVs' determinant is
// left, made orthogonal by two cross products. t points up, v down; how the map is laid on them does not matter.
vec3 in_cyslice(SurfacePoint point, Place place, TextureUse map, vec2 lean) {
    map.map_u = vec3(1.0, 0.0, 0.0);
    map.map_v = vec3(0.0, 1.0, 0.0);
    mat2 changes = map_changes(point, map);
    vec3 along = place.side_2 * changes[0].y - place.side_1 * changes[1].y;
    vec3 t = unit_or_zero(cross(place.front, mapped(place.row + WORLD_ROW, vec4(along, 0.0))));
    return lean.x * t + lean.y * cross(t, place.front);
}

Place place_of(SurfacePoint point, bool faceted) {
    vec3 corner[3];
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        corner[k] = LOAD(positions, point.vertices[k]);
        sum += LOAD(normals, point.vertices[k]) * point.at[k];
    }
    Place place;
    place.side_1 = corner[1] - corner[0];
    place.side_2 = corner[2] - corner[0];
    vec3 across = cross(place.side_1, place.side_2);
    float largest = max(max(abs(across.x), abs(across.y)), abs(across.z));
    place.normal = unit_or_zero(faceted ? (largest > 0.0 ? across / largest : across) : sum);
    place.row = point.instance * INSTANCE_ROWS;
    place.front = point.flip * (faceted ? point.facing : point.normal);
    return place;
}

// What rises by so much along the sides tilts the normal away from it.
vec3 tilted(Place place, vec2 along_sides) {
    vec3 gradient = surface_gradient(place.side_1, place.side_2, place.normal, along_sides);
    float enlarged = length(mapped(place.row + NORMAL_ROW, vec4(place.normal, 0.0)));
    return enlarged > 0.0 ? -mapped(place.row + NORMAL_ROW, vec4(gradient, 0.0)) / enlarged : vec3(0.0);
}

// A normal of the mesh's space in place of the front's.
vec3 in_object_space(Place place, vec3 m) {
    vec3 n = unit_or_zero(mapped(place.row + NORMAL_ROW, vec4(m, 0.0)));
    return n == vec3(0.0) ? n : homogeneous(n, place.front) - place.front;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Bump bump = LOAD(bumps, point.material);
    if (bump.kinds == uvec4(BUMP_NONE) && bump.expression_count == 0u) {
        return;
    }
    bool faceted = (bump.flags & BUMP_FACETED) != 0u;
    Place place = place_of(point, faceted);
    vec3 own = faceted ? place.front : point.flip * LOAD(appearances, i).normal;
    vec3 direction = homogeneous(own, place.front);
    vec2 along_sides = params.has_rises != 0u ? LOAD(rises, i) : vec2(0.0);
    [[dont_unroll]] for (uint slot = 0u; slot < BUMP_SLOTS; ++slot) {
        uint kind = bump.kinds[slot];
        if (kind == BUMP_NONE || (params.maps >> slot & 1u) == 0u) {
            continue;
        }
        TextureUse map = LOAD(maps, point.material * MAP_SLOTS + MAP_DETAIL + slot);
        vec3 value = value_of(slot, i).xyz;
        float scale = bump.scales[slot];
        if (kind == BUMP_HEIGHT) {
            along_sides += scale * (value.xy * map_changes(point, map));
        } else if (kind == BUMP_TANGENT) {
            direction += in_mikktspace(point, place, scale * leaning(value));
        } else if (kind == BUMP_OBJECT) {
            direction += scale * in_object_space(place, value);
        } else {
            direction += in_cyslice(point, place, map, scale * leaning(value));
        }
    }
    direction += tilted(place, along_sides);
    vec3 bent = point.flip * unit_or_zero(direction);
    if (bent != vec3(0.0)) {
        LOAD(appearances, i).normal = bent;
    }
}

#include "batch.glsl"
