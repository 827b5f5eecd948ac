#version 460
#extension GL_GOOGLE_include_directive : require
// What each fragment sees of an environment: by its whole hemisphere, and by the lobe of its roughness, or by a mirror. At
// the pixel's normal, the vertices' and blended, or the triangle's, as light is (see shade_phong). A thread per fragment.
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "raster_tables.glsl"
#include "appearance.glsl"
#include "texel_pair.glsl"
#include "trigonometry.glsl"
#include "brdf.glsl"
#include "surroundings.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint normals; // NORMALS_*
    uint mips;    // levels of the environment's map
    uint lobes;   // of roughness k / lobes, k from 1, after a level of irradiance; 0: every surface is a mirror
    vec4 eye;     // w = 1: a place; w = 0: the direction towards an orthographic camera
} params;

PAGED(0, readonly, SurfacePoint, points);
PAGED(1, readonly, Appearance, appearances);
PAGED(2, readonly, vec3, positions);
PAGED(3, readonly, vec3, normals);
PAGED(4, readonly, vec4, instance_rows);
PAGED(5, readonly, uvec4, environment_levels);
PAGED(6, readonly, TexelPair, environment_texels);
PAGED(7, writeonly, Surroundings, surroundings);
#include "world.glsl"
#include "footprint.glsl"
#include "environment.glsl"

const uint NORMALS_OF_PIXELS = 0u;
const uint NORMALS_OF_VERTICES = 1u;
const uint NORMALS_OF_TRIANGLES = 2u;

// What a lobe of that roughness around `d` sees. Between the mirror and the first rough level the blend goes by the cube of
// roughness: where lobes are narrow they blur by less than their share of the way.
vec3 glossy(vec3 d, float roughness, float footprint) {
    float level = clamp(roughness, 0.0, 1.0) * float(params.lobes);
    uint finer = min(uint(level), max(params.lobes, 1u) - 1u);
    float t = level - float(finer);
    vec2 place = place_of(d);
    vec3 fine = finer == 0u
        ? environment_mirror(d, footprint, params.mips)
        : environment_at(LOAD(environment_levels, params.mips + finer), place);
    if (params.lobes == 0u) {
        return fine;
    }
    vec3 coarse = environment_at(LOAD(environment_levels, params.mips + finer + 1u), place);
    return mix(fine, coarse, finer == 0u ? t * t * t : t);
}

Surroundings seen(vec3 position, vec3 normal, float roughness, float footprint) {
    vec3 v = view_of(params.eye, position).towards;
    vec3 n = visible_normal(normal, v);
    vec3 mirrored = 2.0 * dot(n, v) * n - v;
    // Wide lobes lean towards the normal, where less is shadowed: by alpha squared.
    float lean = params.lobes == 0u ? 0.0 : clamp(roughness * roughness * roughness * roughness, 0.0, 1.0);
    vec3 diffuse = environment_at(LOAD(environment_levels, params.mips), place_of(n));
    return Surroundings(diffuse, glossy(normalize(mix(mirrored, n, lean)), roughness, footprint));
}

// At the vertices, blended as Gouraud (1971) has it.
Surroundings blended(SurfacePoint point, float roughness, float footprint) {
    uint row = point.instance * INSTANCE_ROWS;
    Surroundings sum = Surroundings(vec3(0.0), vec3(0.0));
    [[dont_unroll]] for (uint k = 0u; k < 3u; ++k) {
        vec3 position = mapped(row + WORLD_ROW, vec4(LOAD(positions, point.vertices[k]), 1.0));
        vec3 normal = unit_or_zero(mapped(row + NORMAL_ROW, vec4(LOAD(normals, point.vertices[k]), 0.0)));
        Surroundings corner = seen(position, point.flip * normal, roughness, footprint);
        sum.diffuse += point.at[k] * corner.diffuse;
        sum.specular += point.at[k] * corner.specular;
    }
    return sum;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    vec3 normal = params.normals == NORMALS_OF_TRIANGLES ? point.facing : LOAD(appearances, i).normal;
    float roughness = LOAD(appearances, i).roughness;
    View view = view_of(params.eye, point.position);
    float footprint =
        mirrored_footprint(point, visible_normal(normal, view.towards), view, params.normals == NORMALS_OF_TRIANGLES);
    if (params.normals == NORMALS_OF_VERTICES) {
        STORE(surroundings, i, blended(point, roughness, footprint));
    } else {
        STORE(surroundings, i, seen(point.position, normal, roughness, footprint));
    }
}

#include "batch.glsl"
