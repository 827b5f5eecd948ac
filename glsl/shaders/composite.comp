#version 460
#extension GL_GOOGLE_include_directive : require
// Puts the shaded fragments of a layer behind those of the layers before it (Porter and Duff 1984): a thread per pixel,
// sample by sample. Layers are peeled from front to back (Everitt 2001); the last is what is solid.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "common.glsl"
#include "pages.glsl"
#include "surface_point.glsl"
#include "appearance.glsl"
#include "visibility_key.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // pixels
    uint solid; // alpha counts as 1
} params;

PAGED(0, readonly, uint64_t, visibility); // of the layer
PAGED(1, readonly, uint, pixels);
PAGED(2, readonly, SurfacePoint, points);
PAGED(3, readonly, Appearance, appearances);
PAGED(4, readonly, vec4, radiance);
// Share of what is behind the layers so far that each sample sees, and what each pixel sees of them.
PAGED(5, , float, transmittance);
PAGED(6, , vec3, layered);
// Of each sample, the key of the nearest surface that takes away half of what is behind it.
PAGED(7, , uint64_t, shown);

// The pixel's fragment of a sample, or `number` where there is none.
uint fragment_of(uint s, uint first, uint number) {
    uint found = number;
    for (uint k = 0u; k < number; ++k) {
        if ((LOAD(points, first + k).covered >> s & 1u) != 0u) {
            found = k;
        }
    }
    return found;
}

void element(uint i) {
    uint fragments = LOAD(pixels, i);
    uint first = fragments >> 3;
    uint number = min(fragments & 7u, 4u);
    vec3 color = LOAD(layered, i);
    [[dont_unroll]] for (uint s = 0u; s < 4u; ++s) {
        uint64_t key = LOAD(visibility, i * 4u + s);
        uint k = key == 0ul ? number : fragment_of(s, first, number);
        if (k == number) {
            continue;
        }
        float alpha = params.solid != 0u ? 1.0 : clamp(LOAD(appearances, first + k).base.a, 0.0, 1.0);
        float passes = LOAD(transmittance, i * 4u + s);
        color += LOAD(radiance, first + k).rgb * (0.25 * passes * alpha);
        STORE(transmittance, i * 4u + s, passes * (1.0 - alpha));
        if (alpha >= 0.5 && LOAD(shown, i * 4u + s) == 0ul) {
            STORE(shown, i * 4u + s, key);
        }
    }
    STORE(layered, i, color);
}

#include "batch.glsl"
