// Regions on the map of one height layer, as bound_places leaves them to the passes that bound what is between. Include
// after bound_texels.glsl.

struct MapPlaces {
    vec3 x;
    vec3 y;
    ivec2 origin;
};

// By what a region is bounded.
struct MapUse {
    uint layer; // or NO_LAYER
    float cap;  // unscaled, up to NO_CAP
};

const uint NO_LAYER = 0xffffffffu;
const float NO_CAP = 1e30;

// A line is the side from the first place to the second; a place in between has a value, too.
MapTriangle on_map(const MapPlaces places, const vec3 values, const bool line) {
    return MapTriangle(places.x, places.y, line ? values.xyy : values, places.origin);
}

// Heights at the corners, and what is between: of values and a difference.
vec4 scaled(const Layer layer, const vec3 values, const float difference) {
    return vec4(layer.scale * (values - layer.midlevel), abs(layer.scale) * difference);
}
