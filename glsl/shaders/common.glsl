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
