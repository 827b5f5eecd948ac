// What every pass of the rasteriser knows of a triangle: which use of which mesh it belongs to.
// Mirrored in layout.rs. Include after pages.glsl.

// A run of triangles of one instance and one material. Parts are sorted by first_triangle.
struct Part {
    uint first_triangle; // number over all instances, the triangle id of the visibility key
    uint triangle_base;  // where the run begins in `triangles`
    uint screen_base;    // added, wrapping, to a vertex id to find its place in `screen`
    uint instance;
    uint material;
    uint flags;          // PART_*
    // What is drawn in place of a part that is itself unseen names that part's first triangle, and how many of its own
    // stand for each of them; others name themselves, and 1.
    uint stands_for;
    uint faces;
};

// The instance mirrors: counter-clockwise triangles appear clockwise.
const uint PART_MIRRORED = 1u;
const uint PART_DOUBLE_SIDED = 2u;
const uint PART_MASKED = 4u;
// Its mesh has vertex colours.
const uint PART_COLORED = 8u;
// It is seen through: drawn in layers, after all else.
const uint PART_BLENDED = 16u;
// Where on it is seen, its heights decide.
const uint PART_RELIEF = 64u;
// Others are drawn in its place.
const uint PART_UNSEEN = 32u;

// Rows of an instance's affine maps in `instance_rows`, so many for each instance. The first four give
// homogeneous pixels (x w, y w, z, w) with y down; then world position; then the normal's linear map.
const uint INSTANCE_ROWS = 10u;
const uint WORLD_ROW = 4u;
const uint NORMAL_ROW = 7u;

// Binary search for the part of triangle `id` among parts[first..=last]; needs `parts` in scope.
#define FIND_PART(ID, FIRST, LAST, PART) \
    Part PART; \
    { \
        uint low_ = (FIRST); \
        uint high_ = (LAST); \
        for (uint step_ = 0u; step_ < 32u && low_ < high_; ++step_) { \
            uint middle_ = low_ + (high_ - low_ + 1u) / 2u; \
            if (LOAD(parts, middle_).first_triangle <= (ID)) { low_ = middle_; } else { high_ = middle_ - 1u; } \
        } \
        PART = LOAD(parts, low_); \
    }
