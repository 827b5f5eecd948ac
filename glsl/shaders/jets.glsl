// What the jet passes share: they add, for every sample of one detail, one layer's displacement and its
// derivatives to the jet of the sample's vertex. Include after frame.glsl and sample.glsl.

PAGED(6, readonly, Sample, samples);
PAGED(7, , mat3, jets);

Site site_of_sample(const Sample place) {
    return Site(place.av, vec3(1.0 - place.b.x - place.b.y, place.b), place.patch_code);
}

#ifdef SMOOTH
#include "fields.glsl"

PAGED(13, readonly, Fields, fields); // of the samples

// The frame at sample i.
Frame frame_of(const uint i, const Sample place) {
    Site site = site_of_sample(place);
    vec3 u = jet(site.b, position_u(site.av.x).w, position_u(site.av.y).w, position_u(site.av.z).w);
    vec3 v = jet(site.b, direction_v(site.av.x).w, direction_v(site.av.y).w, direction_v(site.av.z).w);
    Fields own = LOAD(fields, i);
    return Frame(own.position, own.normal, own.direction, u, v);
}
#else
Frame frame_of(const uint i, const Sample place) {
    return frame_at(site_of_sample(place));
}
#endif

void add_jet(const uint i, const Sample place, const mat3 d, const bool accumulate) {
    mat3 turned = mat3(d[0], d[1] * place.turn.x, d[2] * place.turn.y);
    mat3 weighted = product(place.weight, turned);
    STORE(jets, i, accumulate ? LOAD(jets, i) + weighted : weighted);
}
