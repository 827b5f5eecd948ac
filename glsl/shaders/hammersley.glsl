// Point i of `count`, a power of two, of the Hammersley set, moved to the middle of its cells.
vec2 hammersley(uint i, uint count) {
    float share = 1.0 / float(count);
    return vec2(float(i) * share, float(bitfieldReverse(i) >> 8) * (1.0 / 16777216.0)) + 0.5 * share;
}
