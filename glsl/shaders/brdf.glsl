// The metallic-roughness model of glTF 2.0, appendix B: GGX (Walter et al. 2007), height-correlated masking (Heitz 2014),
// Schlick's Fresnel (1994).

const float PI = 3.14159265358979;
// Below it the lobe is narrower than f32 directions tell apart with a few digits: roughness 1/32.
const float MIN_ALPHA = 1.0 / 1024.0;
const float MIN_ROUGHNESS = 1.0 / 32.0;
// Of the normal and the direction to the viewer; a normal that faces away is bent back to it.
const float MIN_COSINE = 1e-4;
// Reflectance of dielectrics seen head on: an index of refraction of 1.5.
const float DIELECTRIC_F0 = 0.04;

// A surface as the model sees it: a dielectric and a metal, mixed. What facets reflect once is that of mixed f0, since
// Schlick's Fresnel is linear in it; only the dielectric's keeps light from its matter.
struct Reflectance {
    vec3 f0;         // of both, seen head on, 0 to 1
    vec3 metal;      // f0 of the metal
    float metallic;  // its share
    vec3 diffuse;    // albedo of matter below facets, times the dielectric's share
    float roughness; // perceptual
    float alpha;     // width of GGX
};

Reflectance reflectance(vec3 base, float metallic, float roughness) {
    metallic = clamp(metallic, 0.0, 1.0);
    roughness = clamp(roughness, MIN_ROUGHNESS, 1.0);
    base = clamp(base, 0.0, 1.0);
    return Reflectance(
        mix(vec3(DIELECTRIC_F0), base, metallic), base, metallic, base * (1.0 - metallic), roughness,
        roughness * roughness);
}

// GGX by the half vector's cosine and squared sine, which keeps its digits where the lobe is narrow.
float distribution(float alpha, float cosine, float sine_squared) {
    float squared = alpha * alpha;
    float spread = squared * cosine * cosine + sine_squared;
    return squared / (PI * spread * spread);
}

float masking(float squared, float cosine) {
    return sqrt(squared + (1.0 - squared) * cosine * cosine);
}

// Masking and shadowing over 4 (n.l) (n.v).
float visibility(float alpha, float nv, float nl) {
    float squared = alpha * alpha;
    return 0.5 / (nl * masking(squared, nv) + nv * masking(squared, nl));
}

// (1 - cosine)^5.
float grazing(float cosine) {
    float x = clamp(1.0 - cosine, 0.0, 1.0);
    return x * x * x * x * x;
}

// `n` as the viewer in direction `v` can see it: one that faces away is bent until it is seen from the side.
vec3 visible_normal(vec3 n, vec3 v) {
    float cosine = dot(n, v);
    if (cosine >= MIN_COSINE) {
        return n;
    }
    vec3 side = n - cosine * v;
    float squared = dot(side, side);
    return squared < 1e-12 ? v : normalize(side * inversesqrt(squared) + MIN_COSINE * v);
}
