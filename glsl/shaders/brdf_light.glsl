// What a surface makes of light: shares of light from everywhere by the table, and the share of one light. Facets pass
// light on to each other as Kulla and Conty (2017) have it. Include after brdf.glsl; needs in scope
//   PAGED(b, readonly, vec3, brdf_table);   of `brdf_table` and `brdf_averages`

const uint TABLE_SIDE = 128u;

// The texel centre at or below x, and how far x is on the way to the next: half a cell beyond the outermost the table
// goes on as a line, so that a roughness of 1 is not that of the last texel.
struct Between {
    uint low;
    float t;
};

Between between(float x) {
    float p = clamp(x, 0.0, 1.0) * float(TABLE_SIDE) - 0.5;
    float low = clamp(floor(p), 0.0, float(TABLE_SIDE - 2u));
    return Between(uint(integer(low)), p - low);
}

vec3 table_row(uint first, Between column) {
    return mix(LOAD(brdf_table, first + column.low), LOAD(brdf_table, first + column.low + 1u), column.t);
}

// Scale and bias of f0, and the diffuse light that a white surface's Fresnel keeps out.
vec3 table_at(float roughness, float cosine) {
    Between row = between(roughness);
    Between column = between(sqrt(cosine));
    return mix(table_row(row.low * TABLE_SIDE, column), table_row((row.low + 1u) * TABLE_SIDE, column), row.t);
}

// Means over the directions of light: of scale, of bias, and of what both leave of 1.
vec3 table_average(float roughness) {
    return table_row(TABLE_SIDE * TABLE_SIDE, between(roughness));
}

// Shares of light that a surface reflects, seen under one angle.
struct Albedo {
    vec3 single;   // at the first facet met
    float grazing; // of it, what Fresnel adds at grazing angles whatever the surface
    vec3 multiple; // after several facets: like diffuse light
    float below;   // what a dielectric leaves for the matter below
};

// Share of light that comes out of facets of one f0 after more than one, of what one facet has not let out.
vec3 passed_on(vec3 f0, float lost) {
    vec3 mean_fresnel = f0 + (1.0 - f0) / 21.0;
    return mean_fresnel * mean_fresnel * (1.0 - lost) / (1.0 - mean_fresnel * lost);
}

// The same of a dielectric's facets.
float passed_on_dielectric(float lost) {
    return passed_on(vec3(DIELECTRIC_F0), lost).x;
}

vec3 passed_on_both(Reflectance surface, float lost) {
    return mix(vec3(passed_on_dielectric(lost)), passed_on(surface.metal, lost), surface.metallic);
}

// Of light from everywhere. Without `multiple` facets pass nothing on to each other, as appendix B has it.
Albedo albedo(Reflectance surface, float nv, bool multiple) {
    vec3 cell = table_at(surface.roughness, nv);
    vec3 single = surface.f0 * cell.x + cell.y;
    if (!multiple) {
        return Albedo(single, cell.y, vec3(0.0), (1.0 - DIELECTRIC_F0) * (1.0 - cell.z));
    }
    float lost = table_average(surface.roughness).z;
    float left = max(1.0 - cell.x - cell.y, 0.0);
    float below = 1.0 - (DIELECTRIC_F0 * cell.x + cell.y) - passed_on_dielectric(lost) * left;
    return Albedo(single, cell.y, passed_on_both(surface, lost) * left, below);
}

// What is weighed by the light of all directions that the surface sees.
vec3 around(Reflectance surface, Albedo seen) {
    return seen.multiple + surface.diffuse * seen.below;
}

// What leaves beside the light that single facets mirror: passed on between facets, and from below them; per steradian,
// times pi. Both fall with what single facets reflect to either side, so that directions can be exchanged. `grazed`: of
// Schlick's Fresnel.
struct Beside {
    vec3 multiple;
    vec3 below;
};

Beside beside_pi(Reflectance surface, Albedo seen, float grazed, float nl, bool multiple) {
    if (!multiple) {
        return Beside(vec3(0.0), surface.diffuse * ((1.0 - DIELECTRIC_F0) * (1.0 - grazed)));
    }
    Albedo lit = albedo(surface, nl, true);
    vec3 average = table_average(surface.roughness);
    vec3 passed = passed_on_both(surface, average.z) * average.z;
    float below = 1.0 - (DIELECTRIC_F0 * average.x + average.y) - passed_on_dielectric(average.z) * average.z;
    return Beside(
        seen.multiple * lit.multiple / max(passed, vec3(1e-12)),
        surface.diffuse * (seen.below * lit.below / max(below, 1e-12)));
}

vec3 fresnel_of(Reflectance surface, float grazed) {
    return surface.f0 + (1.0 - surface.f0) * grazed;
}

// Distribution and masking of one normal, times pi; `nl`: its cosine to `l`.
float lobe_pi(float alpha, vec3 n, vec3 v, vec3 h, float nl) {
    float nv = clamp(dot(n, v), MIN_COSINE, 1.0);
    vec3 across = cross(n, h);
    return PI * distribution(alpha, dot(n, h), dot(across, across)) * visibility(alpha, nv, nl);
}
