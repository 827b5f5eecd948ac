// Maps between two levels of their pyramid. Include after texture_bindings.glsl.

// The level-th level counted from the finest.
uvec4 level_at(TextureUse map, uint level) {
    return LOAD(levels, map.level_first + min(level, map.level_count - 1u));
}

// The map at a level of detail, whole numbers being levels.
vec4 between_levels(TextureUse map, vec2 uv, float level, uvec2 wrap) {
    level = clamp(level, 0.0, float(map.level_count - 1u));
    uint finer = uint(level);
    vec4 value = vec4(0.0);
    [[dont_unroll]] for (uint k = 0u; k < 2u; ++k) {
        float t = level - float(finer);
        float weight = k == 0u ? 1.0 - t : t;
        if (weight > 0.0) {
            value += weight * bilinear(level_at(map, finer + k), uv, wrap);
        }
    }
    return value;
}
