// Paged streams: no binding exceeds 128 MiB, so a stream is a list of pages of 2^22 elements, of texels 2^25.
// Include after common.glsl.

// 0: every stream of this dispatch has a single page, and the page index folds away.
layout(constant_id = 0) const uint PAGED_STREAMS = 0u;
// Elements of a page as a power of two; tests make pages smaller.
layout(constant_id = 1) const uint PAGE_SHIFT = 22u;
const uint PAGE_MASK = (1u << PAGE_SHIFT) - 1u;
const uint MAX_PAGES = 16u;

#define PAGED(BINDING, ACCESS, TYPE, NAME) \
    layout(set = 0, binding = BINDING, scalar) ACCESS buffer NAME##_block { TYPE data[]; } NAME[MAX_PAGES]

// The page number is masked because drivers bound reads within a buffer, not reads past an array of buffers.
uint page_of(const uint i) {
    return PAGED_STREAMS == 0u ? 0u : (i >> PAGE_SHIFT) & (MAX_PAGES - 1u);
}

uint slot_of(const uint i) {
    return PAGED_STREAMS == 0u ? i : i & PAGE_MASK;
}

// One element, as an lvalue. The index is evaluated twice.
#define ELEMENT(NAME, I) NAME[nonuniformEXT(page_of(I))].data[slot_of(I)]
#define LOAD(NAME, I) (ELEMENT(NAME, I))
#define STORE(NAME, I, VALUE) (ELEMENT(NAME, I) = (VALUE))

// Values of maps are words of 4 bytes, where elements have up to 32: eight times as many fit a page, so that a map of
// 16384 x 16384 fits a stream. What the host made by `Stream::of_texels` is read by `LOAD_TEXEL` alone.
const uint TEXELS_MORE_SHIFT = 3u;
const uint TEXELS_SHIFT = PAGE_SHIFT + TEXELS_MORE_SHIFT;
const uint TEXELS_MASK = (1u << TEXELS_SHIFT) - 1u;

uint texel_page_of(const uint i) {
    return PAGED_STREAMS == 0u ? 0u : (i >> TEXELS_SHIFT) & (MAX_PAGES - 1u);
}

uint texel_slot_of(const uint i) {
    return PAGED_STREAMS == 0u ? i : i & TEXELS_MASK;
}

#define LOAD_TEXEL(I) (texels[nonuniformEXT(texel_page_of(I))].data[texel_slot_of(I)])
