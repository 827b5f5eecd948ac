// Where a straight piece meets the bilinear surface over one cell. Include after march.glsl.

// The gap between ray and surface, c + b tau + a tau^2, from where the ray enters the cell to where it leaves it.
struct Gap {
    float a;
    float b;
    float c;
    float stretch; // the tau at which it leaves
};

const float NOWHERE = -1.0;

// The first tau at which a ray that was above is not, or NOWHERE; one that was below is let out first, and `above` is
// what it is thereafter. One that was above and enters below is met at once: no ray slips through between two cells.
// Roots without cancellation (Press et al. 2007, 5.6): q = -(b +- sqrt(b^2 - 4ac)) / 2, the roots c / q and q / a.
float met(Gap gap, inout bool above) {
    precise float discriminant = gap.b * gap.b - 4.0 * gap.a * gap.c;
    float root = sqrt(max(discriminant, 0.0));
    precise float q = -0.5 * (gap.b < 0.0 ? gap.b - root : gap.b + root);
    bool crosses = discriminant >= 0.0;
    // The root that counts first: where a ray above comes down, or one below comes out.
    bool down = gap.c > 0.0;
    bool near = down ? gap.b < 0.0 : gap.b > 0.0;
    bool far = down ? gap.a < 0.0 : gap.a > 0.0;
    float first = (near ? gap.c : q) / (near ? q : gap.a);
    bool found = crosses && (near || far) && first <= gap.stretch;
    if (down) {
        above = true;
        return found ? first : NOWHERE;
    }
    if (above) {
        return 0.0;
    }
    above = found;
    float second = q / gap.a;
    return found && near && gap.a < 0.0 && second <= gap.stretch ? second : NOWHERE;
}

float gap_at_end(Gap gap) {
    return gap.c + (gap.b + gap.a * gap.stretch) * gap.stretch;
}
