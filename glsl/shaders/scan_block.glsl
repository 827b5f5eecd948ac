// Blocks of the prefix sum: 64 threads with 32 items each. Reduce, scan the sums, scan: no workgroup
// ever waits for another, since Vulkan promises no progress between them.

const uint ITEMS_PER_THREAD = 32u;
const uint ITEMS_PER_BLOCK = 64u * ITEMS_PER_THREAD;
