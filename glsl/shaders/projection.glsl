// Where the maps of a surface are read when it has no texture coordinates, or others are wanted: its place in its mesh is
// projected, for each pixel, and so are the place's derivatives, so that neither a seam nor a pole shows in what is
// filtered. Places are relative to the centre of the mesh's box before it is displaced, in units of its longest side.
// Include after trigonometry.glsl.

const uint PROJECTION_UV = 0u; // none of these: texture coordinates
const uint PROJECTION_SPHERE = 1u;
const uint PROJECTION_SPHERE_AS_PRINTED = 2u;
const uint PROJECTION_PLANAR_X = 3u;
const uint PROJECTION_PLANAR_Z = 5u;
const uint PROJECTION_BOX = 6u;
const uint PROJECTION_TRIPLANAR = 7u;

const float TURN = 6.28318530717959;

struct ProjectedPlace {
    vec3 at;
    vec3 dx; // per pixel
    vec3 dy;
    vec3 normal; // unit, or zero
};

struct Projected {
    vec2 uv;
    vec2 dx;
    vec2 dy;
    float weight;
    vec3 tangent;   // unit, towards growing u
    vec3 bitangent; // unit, towards shrinking v: up on the map
};

// How many projections are blended.
uint projections_of(uint kind) {
    return kind == PROJECTION_TRIPLANAR ? 3u : 1u;
}

// Along an axis, so that a map is read as it is from outside; `side` is -1 where that is against the axis.
Projected plane(uint axis, float side, ProjectedPlace place) {
    vec3 right = side * (axis == 0u ? vec3(0.0, 0.0, -1.0) : vec3(1.0, 0.0, 0.0));
    vec3 up = axis == 1u ? vec3(0.0, 0.0, -1.0) : vec3(0.0, 1.0, 0.0);
    mat2x3 axes = mat2x3(right, -up);
    return Projected(vec2(0.5) + place.at * axes, place.dx * axes, place.dy * axes, 1.0, right, up);
}

// u: a turn about +Y from +X over -Z; v: from +Y to -Y. A pixel covers one turn at most.
Projected sphere(ProjectedPlace place, bool as_printed) {
    vec3 p = place.at;
    float level_squared = dot(p.xz, p.xz);
    float level = sqrt(level_squared);
    float squared = level_squared + p.y * p.y;
    float turned = as_printed && p.z > 0.0 ? -1.0 : 1.0;
    float u = turned * arc_tangent2(-p.z, p.x) / TURN;
    float v = arc_tangent2(level, p.y) * (2.0 / TURN);
    vec2 side[2];
    for (int k = 0; k < 2; ++k) {
        vec3 d = k == 0 ? place.dx : place.dy;
        float turn = level_squared > 0.0 ? clamp((p.z * d.x - p.x * d.z) / (TURN * level_squared), -1.0, 1.0) : 1.0;
        float outwards = level > 0.0 ? dot(p.xz, d.xz) / level : length(d.xz);
        float tilt = squared > 0.0 ? (p.y * outwards - level * d.y) * 2.0 / (TURN * squared) : 1.0;
        side[k] = vec2(turned * turn, tilt);
    }
    vec3 along = level > 0.0 ? vec3(p.z, 0.0, -p.x) / level : vec3(0.0, 0.0, -1.0);
    vec3 north = level > 0.0 ? normalize(vec3(-p.y * p.x / level, level, -p.y * p.z / level)) : vec3(-1.0, 0.0, 0.0);
    return Projected(vec2(u - floor(u), v), side[0], side[1], 1.0, turned * along, north);
}

// The axis nearest to the normal.
uint axis_of(vec3 normal) {
    vec3 n = abs(normal);
    return n.x >= n.y && n.x >= n.z ? 0u : (n.y >= n.z ? 1u : 2u);
}

// Weights of the axes (Mikkelsen 2020).
vec3 weights_of(vec3 normal) {
    vec3 w = max(abs(normal) - 0.2, vec3(0.0));
    w = w * w * w;
    float sum = w.x + w.y + w.z;
    return sum > 0.0 ? w / sum : vec3(1.0 / 3.0);
}

// Projection `k` of those that are blended.
Projected projected(uint kind, ProjectedPlace place, uint k) {
    if (kind <= PROJECTION_SPHERE_AS_PRINTED) {
        return sphere(place, kind == PROJECTION_SPHERE_AS_PRINTED);
    }
    if (kind <= PROJECTION_PLANAR_Z) {
        return plane(kind - PROJECTION_PLANAR_X, 1.0, place);
    }
    uint axis = kind == PROJECTION_BOX ? axis_of(place.normal) : k;
    Projected found = plane(axis, place.normal[axis] < 0.0 ? -1.0 : 1.0, place);
    found.weight = kind == PROJECTION_BOX ? 1.0 : weights_of(place.normal)[k];
    return found;
}
