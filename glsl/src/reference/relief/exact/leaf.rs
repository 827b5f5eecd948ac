//! Where a straight piece of a course meets the bilinear surface over one cell.

/// The gap between ray and surface, c + b τ + a τ², from where the ray enters the cell to where it leaves it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub a: f64,
    pub b: f64,
    pub c: f64,
    pub length: f64,
}

/// The τ at which the surface is met, if it is, and whether the ray is above it thereafter.
pub(super) type Met = (Option<f64>, bool);

impl Gap {
    /// The first τ at which a ray that was above is not; one that was below is let out first. A ray that was above and
    /// enters below is met at once: no ray slips through between two cells. Roots without cancellation (Press et al.
    /// 2007, 5.6): q = −(b ± √(b² − 4ac)) / 2, the roots c / q and q / a.
    pub(super) fn met(&self, above: bool) -> Met {
        let Self { a, b, c, length } = *self;
        let discriminant = b * b - 4.0 * a * c;
        let root = discriminant.max(0.0).sqrt();
        let q = -0.5 * if b < 0.0 { b - root } else { b + root };
        let crosses = discriminant >= 0.0;
        let within = |tau: f64| (tau <= length).then_some(tau);
        if c > 0.0 {
            let first = if b < 0.0 { c / q } else { q / a };
            return (if crosses && (b < 0.0 || a < 0.0) { within(first) } else { None }, true);
        }
        if above {
            return (Some(0.0), true);
        }
        let out = if b > 0.0 { c / q } else { q / a };
        let comes_out = crosses && (b > 0.0 || a > 0.0) && out <= length;
        (if comes_out && b > 0.0 && a < 0.0 { within(q / a) } else { None }, comes_out)
    }

    pub(super) fn at_end(&self) -> f64 {
        self.c + (self.b + self.a * self.length) * self.length
    }
}
