// Lets a thread handle several elements: included last, it calls `void element(uint i)` of the including
// pass for every i below `params.count`. Software devices spend more on starting threads than on short
// elements; GPUs take one element per thread.

// Elements per thread; the host divides the number of threads by it.
layout(constant_id = 2) const uint BATCH = 1u;

void main() {
#ifdef PREPARE
    PREPARE
#endif
    uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
    [[dont_unroll]] for (uint k = 0u; k < BATCH; ++k) {
        uint i = (group * BATCH + k) * 64u + gl_LocalInvocationID.x;
        if (i < params.count) {
            element(i);
        }
    }
}
