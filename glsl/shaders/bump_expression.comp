#version 460
#extension GL_GOOGLE_include_directive : require
// How much the heights of a material's formulas rise along two sides of each fragment's triangle, by dual numbers: what
// they have of slope there, were they as steep all along. A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "raster_tables.glsl"
#include "bump.glsl"
#define INSTRUCTIONS_BINDING 6
#define JETS
#include "expression.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint uv_channels; // of each vertex
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, vec3, positions);
PAGED(2, readonly, vec3, normals);
PAGED(3, readonly, vec2, uvs);
PAGED(4, readonly, Bump, bumps);
PAGED(5, readonly, BumpFormula, formulas);
PAGED(7, writeonly, vec2, rises); // from the first vertex to the second, and to the third

// A value and its changes along the two sides.
vec3 along_sides(vec3 corners, vec3 at) {
    return vec3(dot(corners, at), corners.y - corners.x, corners.z - corners.x);
}

// The unit normal's components, with their changes.
mat3 unit_normal(uvec3 v, vec3 at) {
    vec3 a = LOAD(normals, v.x), b = LOAD(normals, v.y), c = LOAD(normals, v.z);
    vec3 n = a * at.x + b * at.y + c * at.z;
    float inverse = 1.0 / max(length(n), 1e-12);
    n *= inverse;
    vec3 by_1 = (b - a) * inverse, by_2 = (c - a) * inverse;
    return transpose(mat3(n, by_1 - n * dot(n, by_1), by_2 - n * dot(n, by_2)));
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Bump bump = LOAD(bumps, point.material);
    if (bump.expression_count == 0u) {
        STORE(rises, i, vec2(0.0));
        return;
    }
    uvec3 v = point.vertices;
    mat3 corners = transpose(mat3(LOAD(positions, v.x), LOAD(positions, v.y), LOAD(positions, v.z)));
    mat3 n = unit_normal(v, point.at);
    vec3 variables[8] = vec3[8](vec3(0.0), vec3(0.0), along_sides(corners[0], point.at),
        along_sides(corners[1], point.at), along_sides(corners[2], point.at), n[0], n[1], n[2]);
    vec2 sum = vec2(0.0);
    [[dont_unroll]] for (uint k = 0u; k < min(bump.expression_count, MOST_FORMULAS); ++k) {
        BumpFormula formula = LOAD(formulas, bump.expression_first + k);
        mat3x2 uv;
        for (int corner = 0; corner < 3; ++corner) {
            uv[corner] = LOAD(uvs, v[corner] * params.uv_channels + formula.uv_channel);
        }
        mat2x3 of_corners = transpose(uv);
        vec3 from_u = along_sides(of_corners[0], point.at), from_v = along_sides(of_corners[1], point.at);
        variables[0] = formula.map_u.x * from_u + formula.map_u.y * from_v + vec3(formula.map_u.z, 0.0, 0.0);
        variables[1] = formula.map_v.x * from_u + formula.map_v.y * from_v + vec3(formula.map_v.z, 0.0, 0.0);
        sum += formula.scale * evaluate(formula.first, formula.count, variables).yz;
    }
    STORE(rises, i, sum);
}

#include "batch.glsl"
