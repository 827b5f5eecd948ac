//! Interval arithmetic over f64, rounded outwards: bounds that hold over a whole box.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::Number;

/// All numbers from `lo` to `hi`; `[−∞, ∞]` where nothing better is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub lo: f64,
    pub hi: f64,
}

/// Two units in the last place, as a share of any number.
const TWO_UNITS: f64 = 2.0 * f64::EPSILON;
/// More than two units of the smallest numbers, and far from them: they are slow to calculate with.
const TINY: f64 = 1e-290;

/// Cells of value noise each way from 0.
const NOISE_LATTICE: f64 = 2_147_483_000.0;

impl Interval {
    pub const WHOLE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    #[must_use]
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Library functions are right to one unit in the last place; two are allowed for.
    #[inline]
    fn outward(lo: f64, hi: f64) -> Self {
        if lo.is_nan() || hi.is_nan() {
            return Self::WHOLE;
        }
        // Infinite ends stay; `min` keeps ∞ − ∞ out.
        let down = lo - (lo.abs() * TWO_UNITS + TINY).min(f64::MAX);
        let up = hi + (hi.abs() * TWO_UNITS + TINY).min(f64::MAX);
        // What cannot be below 0 stays so, for the root of a sum of squares.
        Self { lo: if lo >= 0.0 { down.max(0.0) } else { down }, hi: up }
    }

    /// By what two roundings may have taken away.
    #[inline]
    #[must_use]
    pub fn widened(self) -> Self {
        Self::outward(self.lo, self.hi)
    }

    fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    #[inline]
    fn hull([a, b, c, d]: [f64; 4]) -> Self {
        // min and max would leave a NaN out; the sum does not.
        if (a + b + c + d).is_nan() && (a.is_nan() || b.is_nan() || c.is_nan() || d.is_nan()) {
            return Self::WHOLE;
        }
        Self::outward(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }

    /// Whether the interval is `width` wide or wider, or its width is not a number.
    fn is_at_least(self, width: f64) -> bool {
        let own = self.hi - self.lo;
        own >= width || own.is_nan()
    }

    /// Whether `phase + k period` lies inside for some whole k, erring on the side of yes.
    fn meets(self, phase: f64, period: f64) -> bool {
        let slack = 1e-12 * (1.0 + self.lo.abs().max(self.hi.abs()));
        let k = ((self.lo - slack - phase) / period).ceil();
        phase + k * period <= self.hi + slack
    }

    fn rising(self, f: fn(f64) -> f64) -> Self {
        Self::outward(f(self.lo), f(self.hi))
    }
}

impl Number for Interval {
    #[inline]
    fn constant(value: f64) -> Self {
        Self { lo: value, hi: value }
    }
    #[inline]
    fn add(self, o: Self) -> Self {
        Self::outward(self.lo + o.lo, self.hi + o.hi)
    }
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self::outward(self.lo - o.hi, self.hi - o.lo)
    }
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self::hull([self.lo * o.lo, self.lo * o.hi, self.hi * o.lo, self.hi * o.hi])
    }
    #[inline]
    fn div(self, o: Self) -> Self {
        if o.contains(0.0) {
            return Self::WHOLE;
        }
        Self::hull([self.lo / o.lo, self.lo / o.hi, self.hi / o.lo, self.hi / o.hi])
    }
    #[inline]
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
    fn powi(self, n: i32) -> Self {
        if n < 0 {
            return Self::constant(1.0).div(self.powi(-n));
        }
        let mut ends = Self::hull([self.lo.powi(n), self.hi.powi(n), self.lo.powi(n), self.hi.powi(n)]);
        // Every multiplication rounds.
        (0..n / 2).for_each(|_| ends = ends.widened());
        if n % 2 == 0 && self.contains(0.0) { Self { lo: if n == 0 { 1.0 } else { 0.0 }, ..ends } } else { ends }
    }
    fn sin(self) -> Self {
        self.sub(Self::constant(FRAC_PI_2)).cos()
    }
    fn cos(self) -> Self {
        if !self.is_finite() {
            return Self::WHOLE;
        }
        if self.is_at_least(TAU) {
            return Self { lo: -1.0, hi: 1.0 };
        }
        let ends = Self::hull([self.lo.cos(), self.hi.cos(), self.lo.cos(), self.hi.cos()]);
        Self {
            lo: if self.meets(PI, TAU) { -1.0 } else { ends.lo.max(-1.0) },
            hi: if self.meets(0.0, TAU) { 1.0 } else { ends.hi.min(1.0) },
        }
    }
    fn tan(self) -> Self {
        if self.is_at_least(PI) || self.meets(FRAC_PI_2, PI) { Self::WHOLE } else { self.rising(f64::tan) }
    }
    #[inline]
    fn sqrt(self) -> Self {
        if self.lo < 0.0 { Self::WHOLE } else { self.rising(f64::sqrt) }
    }
    #[inline]
    fn abs(self) -> Self {
        let (a, b) = (self.lo.abs(), self.hi.abs());
        Self { lo: if self.contains(0.0) { 0.0 } else { a.min(b) }, hi: a.max(b) }
    }
    #[inline]
    fn min(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.min(o.hi) }
    }
    #[inline]
    fn max(self, o: Self) -> Self {
        Self { lo: self.lo.max(o.lo), hi: self.hi.max(o.hi) }
    }
    fn floor(self) -> Self {
        Self { lo: self.lo.floor(), hi: self.hi.floor() }
    }
    fn sign(self) -> Self {
        Self { lo: Number::sign(self.lo), hi: Number::sign(self.hi) }
    }
    fn step(edge: Self, x: Self) -> Self {
        Self { lo: Number::step(edge.hi, x.lo), hi: Number::step(edge.lo, x.hi) }
    }
    fn exp2(self) -> Self {
        let raw = self.rising(f64::exp2);
        Self { lo: raw.lo.max(0.0), ..raw }
    }
    fn log2(self) -> Self {
        if self.lo <= 0.0 { Self::WHOLE } else { self.rising(f64::log2) }
    }
    fn atan2(self, x: Self) -> Self {
        let cut = x.lo <= 0.0 && self.contains(0.0);
        if cut {
            return Self { lo: -PI, hi: PI };
        }
        // Away from the cut the angle takes its extremes at the corners of the box.
        let corners = [(self.lo, x.lo), (self.lo, x.hi), (self.hi, x.lo), (self.hi, x.hi)];
        Self::hull(corners.map(|(y, x)| y.atan2(x)))
    }
    fn noise(x: Self, y: Self, z: Self) -> Self {
        // Beyond its lattice it grows without bound.
        let is_inside = |n: Self| n.lo > -NOISE_LATTICE && n.hi < NOISE_LATTICE;
        if [x, y, z].into_iter().all(is_inside) { Self { lo: -1.0, hi: 1.0 } } else { Self::WHOLE }
    }
    fn smooth(self) -> Self {
        // Rising on [0, 1], where smoothstep uses it.
        if self.lo < 0.0 || self.hi > 1.0 { Self::WHOLE } else { self.rising(|x| x * x * (3.0 - 2.0 * x)) }
    }
    fn modulo(self, y: Self) -> Self {
        // Between 0 and y, whichever way y points; the plain formula when one period covers the box.
        let plain = self.sub(y.mul(self.div(y).floor()));
        let period = Self { lo: y.lo.min(0.0), hi: y.hi.max(0.0) };
        let within = Self { lo: plain.lo.max(period.lo), hi: plain.hi.min(period.hi) };
        if y.contains(0.0) || !self.is_finite() || !y.is_finite() { Self::WHOLE } else { within }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Claims that f over the interval holds f of many points of it.
    fn holds(f: fn(Interval) -> Interval, g: fn(f64) -> f64, lo: f64, hi: f64) {
        let bound = f(Interval::new(lo, hi));
        for k in 0..=1000 {
            let x = lo + (hi - lo) * f64::from(k) / 1000.0;
            assert!(bound.contains(g(x)), "{x} in [{lo}, {hi}] gives {} outside {bound:?}", g(x));
        }
    }

    #[test]
    fn bounds_hold_every_value() {
        for lo in [-9.0, -1.3, -0.2, 0.1, 2.0, 40.0] {
            for width in [0.0, 0.4, 1.9, 3.2, 9.0] {
                let hi = lo + width;
                holds(Number::sin, f64::sin, lo, hi);
                holds(Number::cos, f64::cos, lo, hi);
                holds(Number::tan, f64::tan, lo, hi);
                holds(Number::abs, f64::abs, lo, hi);
                holds(Number::exp2, f64::exp2, lo, hi);
                holds(|x| x.powi(3), |x| x.powi(3), lo, hi);
                holds(|x| x.powi(4), |x| x.powi(4), lo, hi);
                holds(|x| x.powi(-2), |x| x.powi(-2), lo, hi);
                holds(|x| x.modulo(Interval::constant(0.7)), |x| Number::modulo(x, 0.7), lo, hi);
                holds(|x| x.atan2(Interval::constant(0.3)), |x| x.atan2(0.3), lo, hi);
                holds(|x| Interval::constant(0.3).atan2(x), |x| 0.3f64.atan2(x), lo, hi);
            }
        }
    }

    #[test]
    fn what_may_be_no_number_has_no_bound() {
        let whole = Interval::WHOLE;
        let pole = Interval::constant(1.0).div(Interval::new(-1.0, 1.0));
        let one = Interval::constant(1.0);
        for bound in [pole.sin(), pole.cos(), pole.modulo(one), Interval::noise(pole, one, one), pole.sqrt()] {
            assert_eq!(bound, whole);
        }
        assert_eq!(Interval::noise(Interval::new(0.0, 3e9), one, one), whole);
    }

    #[test]
    fn a_narrow_sine_has_a_narrow_bound() {
        let bound = Interval::new(0.1, 0.2).sin();
        assert!(bound.hi - bound.lo < 0.1);
    }
}
