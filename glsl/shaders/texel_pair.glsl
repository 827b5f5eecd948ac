// Texels of maps that are shaded with: linear RGBA. Two fill an element, so that a stream holds 2^27 of them.
// Include after pages.glsl.
struct TexelPair {
    vec4 texel[2];
};

// Texel I of the stream `texels`, as an lvalue. The index is evaluated more than once.
#define TEXEL(I) (ELEMENT(texels, (I) >> 1).texel[(I) & 1u])
