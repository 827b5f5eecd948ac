// What every pass shares: extensions and the thread index. Included right after #version.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_nonuniform_qualifier : require
// For [[dont_unroll]]: software devices compile at the first dispatch, and unrolled loops multiply that time.
#extension GL_EXT_control_flow_attributes : require

// Groups of one row of a dispatch; the host splits large dispatches by rows.
const uint GROUPS_PER_ROW = 4096u;

uint thread_index() {
    return (gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
}

// A whole number of at most 2^22 as an integer. Adding 1.5 * 2^23 puts it into the lowest bits: software devices
// convert numbers one by one, with tests for what does not fit.
int integer(const float whole) {
    precise float shifted = whole + 12582912.0;
    return floatBitsToInt(shifted) - 0x4B400000;
}
