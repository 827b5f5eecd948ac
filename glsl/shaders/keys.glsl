// Numbers of edges that follow from where they are, not from the order of a file: sides as long as each other are told
// apart by them. The twin is `reference/keys.rs`.

// Of edges that come of splitting a side: its halves, the one from its middle to the corner across, and the one from the
// middle of another side to that middle.
const uint HALF = 1u;
const uint ACROSS = 2u;
const uint BETWEEN = 3u;

uint mixed(const uint x) {
    uint y = (x ^ (x >> 16)) * 0x85EBCA6Bu;
    y = (y ^ (y >> 13)) * 0xC2B2AE35u;
    return y ^ (y >> 16);
}

uint next_key(const uint side, const uint step) {
    return mixed(side + step);
}
