// Numbers beyond the texels of a map.

// The texel that stands for number i of an endless row.
int tiled(int i, int size, uint wrap) {
    if (wrap != 0u) { // WRAP_CLAMP
        return clamp(i, 0, size - 1);
    }
    int rest = i % size;
    return rest < 0 ? rest + size : rest;
}
