// A hierarchy of boxes without pointers to children: nodes lie in the order of a walk. Mirrored in layout.rs.
struct BvhNode {
    vec3 low; // world
    uint skip; // the node after all that is below this one
    vec3 high;
    uint first; // of a leaf's occluders; BVH_INNER of others
};

const uint BVH_INNER = 0xFFFFFFFFu;
// Products of rounded differences and reciprocals are off by no more (Ize 2013).
const float BVH_SLACK = 1.0000005;
