// Maps of materials as shading reads them: where their texels are, how they wrap, and bilinear values. Needs `levels`
// and `texels` in scope:
//   PAGED(b, readonly, uvec4, levels);      first texel (even), width, height, bits of the scale of alpha
//   PAGED(b, readonly, TexelPair, texels);  linear RGBA
// Include after them, texel_pair.glsl and texture_use.glsl.

const uint WRAP_REPEAT = 0u;
const uint WRAP_MIRROR = 1u;
const uint WRAP_CLAMP = 2u;

// Into one period of a repeating map, two of a mirrored one, so that texel numbers stay small.
float periodic(float u, uint mode) {
    float period = mode == WRAP_MIRROR ? 2.0 : 1.0;
    return mode == WRAP_CLAMP ? clamp(u, -1.0, 2.0) : u - floor(u / period) * period;
}

// Texel number for the number of a place in the period; one texel may stick out on either side.
int wrapped(int i, int size, uint mode) {
    if (mode == WRAP_REPEAT) {
        i = i < 0 ? i + size : (i >= size ? i - size : i);
    } else if (mode == WRAP_MIRROR) {
        i = i < 0 ? -1 - i : i;
        i = i >= 2 * size ? i - 2 * size : i;
        i = i >= size ? 2 * size - 1 - i : i;
    }
    return clamp(i, 0, size - 1);
}

// The same for a number up to 64 sizes below the first texel, or any number above.
int repeated(int i, int size, uint mode) {
    if (mode == WRAP_CLAMP) {
        return clamp(i, 0, size - 1);
    }
    uint period = uint(mode == WRAP_MIRROR ? 2 * size : size);
    int place = int(uint(i + 64 * size) % period);
    return place < size ? place : 2 * size - 1 - place;
}

uvec2 wraps_of(TextureUse map) {
    return uvec2(map.wrap & 3u, map.wrap >> 2);
}

// The texel under (u, v).
vec4 nearest(uvec4 level, vec2 uv, uvec2 wrap) {
    ivec2 size = ivec2(level.yz);
    vec2 p = floor(vec2(periodic(uv.x, wrap.x), periodic(uv.y, wrap.y)) * vec2(size));
    ivec2 i = ivec2(wrapped(integer(p.x), size.x, wrap.x), wrapped(integer(p.y), size.y, wrap.y));
    vec4 value = TEXEL(level.x + uint(i.y * size.x + i.x));
    return vec4(value.rgb, min(value.a * uintBitsToFloat(level.w), 1.0));
}

// The level of a map at (u, v), texel i of n at (i + 1/2) / n; alpha is scaled so that levels cover alike.
vec4 bilinear(uvec4 level, vec2 uv, uvec2 wrap) {
    ivec2 size = ivec2(level.yz);
    vec2 p = vec2(periodic(uv.x, wrap.x), periodic(uv.y, wrap.y)) * vec2(size) - 0.5;
    vec2 f = p - floor(p);
    ivec2 i = ivec2(integer(floor(p.x)), integer(floor(p.y)));
    ivec2 x = ivec2(wrapped(i.x, size.x, wrap.x), wrapped(i.x + 1, size.x, wrap.x));
    ivec2 y = ivec2(wrapped(i.y, size.y, wrap.y), wrapped(i.y + 1, size.y, wrap.y)) * size.x;
    vec4 top = mix(TEXEL(level.x + uint(y.x + x.x)), TEXEL(level.x + uint(y.x + x.y)), f.x);
    vec4 bottom = mix(TEXEL(level.x + uint(y.y + x.x)), TEXEL(level.x + uint(y.y + x.y)), f.x);
    vec4 value = mix(top, bottom, f.y);
    return vec4(value.rgb, min(value.a * uintBitsToFloat(level.w), 1.0));
}
