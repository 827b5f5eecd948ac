// Keys of the visibility buffer: depth bits above, the complement of the triangle id below; 0 where nothing is. The
// larger of two is in front: depth is reversed, and of equal depths the smaller id counts.

const uint NOTHING = 0xFFFFFFFFu;

uint64_t key_of(uint id, uint depth_bits) {
    return packUint2x32(uvec2(0xFFFFFFFFu - id, depth_bits));
}

uint id_of(uint64_t key) {
    return key == 0ul ? NOTHING : 0xFFFFFFFFu - uint(key & 0xFFFFFFFFul);
}
