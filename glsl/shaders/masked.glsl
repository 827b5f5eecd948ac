// The alpha test: fragments that pass their material's cut-off, or a threshold by chance, become visible. A thread per
// fragment.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#ifndef WORDS
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "common.glsl"
#include "pages.glsl"
#include "fragment.glsl"
#include "surface_point.glsl"
#include "material.glsl"
#include "vertex_color.glsl"
#include "chance.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform MaskedParams {
    uint count;
    ivec2 slab_px;
    ivec2 slab_size_px;
    uint has_colors;
    uint has_map;
    uint stage; // of keys that are written by halves
} params;

PAGED(1, readonly, Fragment, fragments);
PAGED(2, readonly, SurfacePoint, points);
PAGED(3, readonly, Material, materials);
PAGED(4, readonly, vec4, colors);
PAGED(5, readonly, vec4, mapped_base_color);
#include "visibility.glsl"

float alpha_of(SurfacePoint point, Material m, uint i) {
    float alpha = m.base_color.a;
    if (params.has_colors != 0u) {
        alpha *= VERTEX_COLOR(point).a;
    }
    return params.has_map != 0u ? alpha * LOAD(mapped_base_color, i).a : alpha;
}

void element(uint i) {
    SurfacePoint point = LOAD(points, i);
    Material m = LOAD(materials, point.material);
    Fragment fragment = LOAD(fragments, i);
    // What relief has left nothing of.
    if (point.id == NOTHING) {
        return;
    }
    ivec2 pixel = ivec2(floor(fragment.at_px));
    int s = int((fragment.at_px.y - float(pixel.y)) * 4.0);
    bool stochastic = (m.flags & MATERIAL_STOCHASTIC) != 0u;
    if (alpha_of(point, m, i) < (stochastic ? threshold_of(pixel, s, point.id) : m.alpha_cutoff)) {
        return;
    }
    write_visibility(point.id, sample_place(pixel, s), point.covered);
}

#include "batch.glsl"
