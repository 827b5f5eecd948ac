// Where a map goes on as it is, and where what lies at its border repeats. Include after bound_texels.glsl.

bool is_clamped(const MapAxis axis) {
    return axis.high == axis.top;
}

// Where the map does not repeat what lies at its border.
Window domain_of(const Layer layer, const ivec2 origin) {
    bvec2 clamped = bvec2(is_clamped(layer.across), is_clamped(layer.down));
    vec2 high = vec2(ivec2(layer.across.top, layer.down.top) - origin);
    return Window(mix(vec2(-FAR), vec2(-origin), clamped), mix(vec2(FAR), high, clamped));
}
