#version 460
#extension GL_GOOGLE_include_directive : require
// Means of the table's rows over the directions of light. A thread per row; the results follow the table.
#include "common.glsl"
#include "pages.glsl"

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count; // rows, and cells of a row
} params;

// After the rows: means of x, of y, and of what both leave of 1.
PAGED(0, , vec3, brdf_table);

void element(uint i) {
    uint side = params.count;
    vec3 sum = vec3(0.0);
    float total = 0.0;
    [[dont_unroll]] for (uint k = 0u; k < side; ++k) {
        // The cosine is x squared, so its cosine-weighted measure is that of x cubed.
        float x = (float(k) + 0.5) / float(side);
        float weight = x * x * x;
        vec3 cell = LOAD(brdf_table, i * side + k);
        sum += weight * vec3(cell.xy, 1.0 - cell.x - cell.y);
        total += weight;
    }
    STORE(brdf_table, side * side + i, sum / total);
}

#include "batch.glsl"
