//! Interval dual numbers: bounds of a function and of its slopes over a whole region.

use super::{Interval, Number};

/// What a function of (b1, b2) and its two partial derivatives can be anywhere in a region. Where the function
/// has a kink in the region, the slopes hold those of both sides; where it jumps, they hold everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalJet {
    pub value: Interval,
    pub slope: [Interval; 2],
}

const ZERO: Interval = Interval::new(0.0, 0.0);
/// Steepest value noise: the quintic fade is steepest at 15/8, between corners 2 apart.
const NOISE_SLOPE: Interval = Interval::new(-3.75, 3.75);

impl IntervalJet {
    #[must_use]
    pub const fn new(value: Interval, slope: [Interval; 2]) -> Self {
        Self { value, slope }
    }

    /// f(self) where `slope` bounds f'.
    fn chain(self, value: Interval, slope: Interval) -> Self {
        Self { value, slope: self.slope.map(|d| product(d, slope)) }
    }

    /// f(self, o) where `a` and `b` bound f's partial derivatives.
    #[inline]
    fn chain2(self, o: Self, value: Interval, a: Interval, b: Interval) -> Self {
        let slope = std::array::from_fn(|k| sum(product(self.slope[k], a), product(o.slope[k], b)));
        Self { value, slope }
    }

    /// A function that is constant between jumps.
    fn stepped(self, value: Interval) -> Self {
        let slope = if value.lo == value.hi { ZERO } else { Interval::WHOLE };
        Self { value, slope: self.slope.map(|d| product(d, slope)) }
    }

    /// Where either of two may hold.
    fn either(self, o: Self, value: Interval) -> Self {
        Self { value, slope: std::array::from_fn(|k| hull(self.slope[k], o.slope[k])) }
    }
}

/// 0 times what is finite is 0, and not only near it.
#[inline]
fn value_product(a: Interval, b: Interval) -> Interval {
    let is_finite = |i: Interval| i.lo.is_finite() && i.hi.is_finite();
    if a == ZERO && is_finite(b) || b == ZERO && is_finite(a) { ZERO } else { a.mul(b) }
}

/// What is flat stays flat, even beside an infinite slope: 0 · ∞ is 0 here.
#[inline]
fn product(a: Interval, b: Interval) -> Interval {
    if a == ZERO || b == ZERO { ZERO } else { a.mul(b) }
}

/// What is flat adds nothing, not even rounding.
#[inline]
fn sum(a: Interval, b: Interval) -> Interval {
    if a == ZERO {
        b
    } else if b == ZERO {
        a
    } else {
        a.add(b)
    }
}

#[inline]
#[must_use]
pub fn hull(a: Interval, b: Interval) -> Interval {
    Interval::new(a.lo.min(b.lo), a.hi.max(b.hi))
}

impl Number for IntervalJet {
    #[inline]
    fn constant(value: f64) -> Self {
        Self { value: Interval::constant(value), slope: [ZERO; 2] }
    }
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { value: self.value.add(o.value), slope: std::array::from_fn(|k| sum(self.slope[k], o.slope[k])) }
    }
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self { value: self.value.sub(o.value), slope: std::array::from_fn(|k| sum(self.slope[k], o.slope[k].neg())) }
    }
    #[inline]
    fn mul(self, o: Self) -> Self {
        self.chain2(o, value_product(self.value, o.value), o.value, self.value)
    }
    #[inline]
    fn div(self, o: Self) -> Self {
        let one = Interval::constant(1.0);
        self.chain2(o, self.value.div(o.value), one.div(o.value), self.value.div(o.value.powi(2)).neg())
    }
    fn neg(self) -> Self {
        Self { value: self.value.neg(), slope: self.slope.map(Number::neg) }
    }
    fn powi(self, n: i32) -> Self {
        let slope = if n == 0 { ZERO } else { Interval::constant(f64::from(n)).mul(self.value.powi(n - 1)) };
        self.chain(self.value.powi(n), slope)
    }
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.value.cos(), self.value.sin().neg())
    }
    fn tan(self) -> Self {
        let t = self.value.tan();
        self.chain(t, Interval::constant(1.0).add(t.powi(2)))
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, Interval::constant(0.5).div(root))
    }
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.sign())
    }
    fn min(self, o: Self) -> Self {
        let value = self.value.min(o.value);
        if self.value.hi < o.value.lo {
            self
        } else if o.value.hi < self.value.lo {
            o
        } else {
            self.either(o, value)
        }
    }
    fn max(self, o: Self) -> Self {
        self.neg().min(o.neg()).neg()
    }
    fn floor(self) -> Self {
        self.stepped(self.value.floor())
    }
    fn sign(self) -> Self {
        self.stepped(self.value.sign())
    }
    fn step(edge: Self, x: Self) -> Self {
        let value = Interval::step(edge.value, x.value);
        let (a, b) = (edge.stepped(value), x.stepped(value));
        Self { value, slope: std::array::from_fn(|k| a.slope[k].add(b.slope[k])) }
    }
    fn exp2(self) -> Self {
        let value = self.value.exp2();
        self.chain(value, value.mul(Interval::constant(std::f64::consts::LN_2)))
    }
    fn log2(self) -> Self {
        self.chain(self.value.log2(), Interval::constant(std::f64::consts::LOG2_E).div(self.value))
    }
    fn atan2(self, x: Self) -> Self {
        let value = self.value.atan2(x.value);
        let square = self.value.powi(2).add(x.value.powi(2));
        let cut = x.value.lo <= 0.0 && self.value.contains(0.0);
        let by = |d: Interval| if cut { Interval::WHOLE } else { d.div(square) };
        self.chain2(x, value, by(x.value), by(self.value.neg()))
    }
    fn noise(x: Self, y: Self, z: Self) -> Self {
        let value = Interval::noise(x.value, y.value, z.value);
        let steepest = if value == Interval::WHOLE { value } else { NOISE_SLOPE };
        let slope = |k: usize| {
            let one = |n: Self| product(n.slope[k], steepest);
            sum(one(x), sum(one(y), one(z)))
        };
        Self { value, slope: std::array::from_fn(slope) }
    }
    fn smooth(self) -> Self {
        let one = Interval::constant(1.0);
        let slope = Interval::constant(6.0).mul(self.value).mul(one.sub(self.value));
        self.chain(self.value.smooth(), slope)
    }
    fn modulo(self, y: Self) -> Self {
        // x − y floor(x / y): within one period the slope is that of x − k y, elsewhere it jumps.
        let periods = self.value.div(y.value).floor();
        let value = self.value.modulo(y.value);
        if periods.lo == periods.hi {
            let plain = self.sub(y.mul(Self { value: periods, slope: [ZERO; 2] }));
            return Self { value, ..plain };
        }
        let jump = |k: usize| if self.slope[k] == ZERO && y.slope[k] == ZERO { ZERO } else { Interval::WHOLE };
        Self { value, slope: std::array::from_fn(jump) }
    }
}
