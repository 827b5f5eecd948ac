// What GGX becomes over normals whose slopes scatter like a Gaussian (after LEAN, Olano and Baker 2010, and LEADR, Dupuy
// et al. 2013, which scatter Beckmann's lobe). Include after brdf.glsl and spread.glsl.
//
// Slopes of GGX's facets have Student's bivariate distribution with two degrees of freedom: a mean, over E of the
// exponential distribution, of Gaussians of variance alpha^2 / (2 E). Each of them is scattered by the normals' Gaussian in
// closed form, and the normals that then have a facet at the half vector are a Gaussian again, met here by two of its
// points, with the lobe itself there. See the twin for why it is this and not a lobe that is merely wider.

const uint LOBE_PARTS = 12u;
// Values of E between which the mean is taken: from next to none of the lobe, to what next to nothing of it is beyond.
const float MOST_E = 8.0;
const float LEAST_E = 0.02;
// Share of alpha^2 below which normals count as one.
const float LEAST_SPREAD = 1e-3;
// Half vectors farther from the normal have no slope worth the name.
const float LEAST_NH = 1e-3;

// Normals around `n`, in units of slope.
struct Scatter {
    vec3 n;
    mat2x3 axes;   // unit
    vec2 variance; // along them
};

Scatter scatter_of(vec3 n, Spread spread) {
    vec2 variance = vec2(dot(spread.major, spread.major), dot(spread.minor, spread.minor));
    // What bends normals further has not turned the spread with them.
    vec3 x = spread.major - dot(spread.major, n) * n;
    x *= inversesqrt(max(dot(x, x), 1e-30));
    return Scatter(n, mat2x3(x, cross(n, x)), variance);
}

bool is_one_normal(Scatter s, float alpha) {
    return s.variance.x <= LEAST_SPREAD * alpha * alpha;
}

// The lobe of the normal of a slope, and the cosine of light, over the distribution that the slope was drawn by.
float over_slope(Scatter s, vec2 slope, float alpha, vec3 v, vec3 l, vec3 h, vec2 apart) {
    vec3 n = visible_normal(normalize(s.n + s.axes * slope), v);
    float nl = min(dot(n, l), 1.0);
    if (nl <= 0.0) {
        return 0.0;
    }
    vec3 across = cross(n, h);
    float cosine = dot(n, h);
    float squared = alpha * alpha;
    float ratio = (squared + dot(apart, apart)) / (squared * cosine * cosine + dot(across, across));
    return ratio * ratio * visibility(alpha, clamp(dot(n, v), MIN_COSINE, 1.0), nl) * nl;
}

// Mean over the normals of distribution, masking and the light's cosine.
float lobe_of_normals(Scatter s, float alpha, vec3 v, vec3 l, vec3 h) {
    float nh = dot(s.n, h);
    if (nh < LEAST_NH) {
        return 0.0;
    }
    vec2 x = h * s.axes / nh;
    float squared = alpha * alpha;
    float step = log(MOST_E * (squared + dot(x, x)) / (LEAST_E * squared)) / float(LOBE_PARTS - 1u);
    float sum = 0.0;
    [[dont_unroll]] for (uint k = 0u; k < LOBE_PARTS; ++k) {
        float e = MOST_E * exp(-float(k) * step);
        float tau = squared / (2.0 * e);
        vec2 total = s.variance + tau;
        vec2 pulled = s.variance / total;
        float weight = step * e * exp(-e - 0.5 * dot(x, x / total)) / (2.0 * PI * sqrt(total.x * total.y));
        vec2 reach = sqrt(2.0 * tau * pulled) * ((k & 1u) == 0u ? vec2(1.0, 0.0) : vec2(0.0, 1.0));
        vec2 apart = x * (tau / total);
        float here = over_slope(s, pulled * x + reach, alpha, v, l, h, apart - reach)
            + over_slope(s, pulled * x - reach, alpha, v, l, h, apart + reach);
        sum += weight * 0.5 * here;
    }
    return sum;
}

// Mean cosine of light from `l` over normals that face it (the mean of a Gaussian's positive part, its softplus).
float cosine_of_normals(Scatter s, vec3 l) {
    float shrunk = inversesqrt(1.0 + s.variance.x + s.variance.y);
    vec2 along = l * s.axes;
    float deviation = max(shrunk * sqrt(dot(along * along, s.variance)), 1e-6);
    float mean = shrunk * dot(s.n, l);
    const float STEEPNESS = 1.7376;
    return max(mean, 0.0) + deviation / STEEPNESS * log(1.0 + exp(-STEEPNESS * abs(mean) / deviation));
}
