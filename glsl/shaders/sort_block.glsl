// Blocks of the radix sort (LSD; Knuth 1998, 5.2.5): 64 threads with 32 records each, in the order of the threads, so
// that records of one digit keep their order. Include after scan_block.glsl.

const uint DIGIT_BITS = 4u;
const uint DIGITS = 1u << DIGIT_BITS;

// One column for each thread.
shared uint histogram[DIGITS * 64u];

uint digit_of(const uint key, const uint shift) {
    return (key >> shift) & (DIGITS - 1u);
}
