// What the jet passes share: they add, for every sample of one detail, one layer's displacement and its
// derivatives to the jet of the sample's vertex. Include after frame.glsl and sample.glsl.

PAGED(6, readonly, Sample, samples);
PAGED(7, , mat3, jets);

Site site_of_sample(const Sample place) {
    return Site(place.av, vec3(1.0 - place.b.x - place.b.y, place.b));
}

void add_jet(const uint i, const Sample place, const mat3 d, const bool accumulate) {
    mat3 turned = mat3(d[0], d[1] * place.turn.x, d[2] * place.turn.y);
    mat3 weighted = product(place.weight, turned);
    STORE(jets, i, accumulate ? LOAD(jets, i) + weighted : weighted);
}
