// Evaluates the base surface at fine vertices: position, uv, displacement direction and, where a layer
// reads them, normal and tangent.
#include "common.glsl"
#include "pages.glsl"
#include "lattice.glsl"
#include "tables.glsl"
#include "frame.glsl"
#ifdef SMOOTH
#include "smooth.glsl"
#endif

layout(local_size_x = 64) in;

layout(push_constant, scalar) uniform Params {
    uint count;
    uint first; // fine vertex of the first thread
    uint block;
    uint with_normals;
    uint with_tangents;
    Lattice lattice;
} params;

PAGED(6, writeonly, vec4, base_position_u);
PAGED(7, writeonly, vec4, base_direction_v);
PAGED(8, writeonly, vec3, base_normals);
PAGED(9, writeonly, vec4, base_tangents);

void element(uint i) {
    Site site = site_of(params.lattice, params.block, i);
    i += params.first;
    vec4 position = blend(site.b, position_u(site.av.x), position_u(site.av.y), position_u(site.av.z));
    vec4 direction = blend(site.b, direction_v(site.av.x), direction_v(site.av.y), direction_v(site.av.z));
#ifdef SMOOTH
    Fields fields = fields_at(site);
    position.xyz = fields.position[0];
    direction.xyz = fields.direction[0];
    vec3 normal = fields.normal[0];
#else
    vec3 normal = blend(site.b, normal_of(site.av.x), normal_of(site.av.y), normal_of(site.av.z));
#endif
    float size = length(normal);
    // A corner's own normal is unit: its direction stays as it is.
    float divisor = params.block == CORNERS ? 1.0 : max(size, MIN_BLENDED_NORMAL);
    precise vec3 unit_offset = direction.xyz / divisor;
    STORE(base_position_u, i, position);
    STORE(base_direction_v, i, vec4(unit_offset, direction.w));
    if ((params.with_normals | params.with_tangents) == 0u) {
        return;
    }
    vec3 unit = size > 0.0 ? normal / size : normal_of(site.av.x);
    STORE(base_normals, i, unit);
    if (params.with_tangents == 0u) {
        return;
    }
    vec4 tangent = blend(site.b, tangent_of(site.av.x), tangent_of(site.av.y), tangent_of(site.av.z));
    vec3 q = tangent.xyz - unit * dot(unit, tangent.xyz);
    vec3 along = dot(q, q) > MIN_TANGENT_SQUARE ? q / length(q) : any_perpendicular(unit);
    STORE(base_tangents, i, vec4(along, tangent.w < 0.0 ? -1.0 : 1.0));
}

#include "batch.glsl"
