//! Dual numbers: a value and its exact partial derivatives by N parameters.

use super::{Number, noise};

/// `value + Σ derivative[k] ε_k`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    pub value: f64,
    pub derivative: [f64; N],
}

impl<const N: usize> Dual<N> {
    #[must_use]
    pub const fn new(value: f64, derivative: [f64; N]) -> Self {
        Self { value, derivative }
    }

    /// f(self) where `slope` is f' at the value.
    fn chain(self, value: f64, slope: f64) -> Self {
        // What is flat stays flat, even beside an infinite slope: 0 · ∞ is 0 here.
        let derivative = self.derivative.map(|d| if d == 0.0 || slope == 0.0 { 0.0 } else { d * slope });
        Self { value, derivative }
    }

    /// f(self, o) where `a` and `b` are f's partial derivatives.
    fn chain2(self, o: Self, value: f64, a: f64, b: f64) -> Self {
        let (x, y) = (self.chain(value, a), o.chain(value, b));
        Self { value, derivative: std::array::from_fn(|k| x.derivative[k] + y.derivative[k]) }
    }
}

impl<const N: usize> Number for Dual<N> {
    fn constant(value: f64) -> Self {
        Self { value, derivative: [0.0; N] }
    }
    fn add(self, o: Self) -> Self {
        self.chain2(o, self.value + o.value, 1.0, 1.0)
    }
    fn sub(self, o: Self) -> Self {
        self.chain2(o, self.value - o.value, 1.0, -1.0)
    }
    fn mul(self, o: Self) -> Self {
        self.chain2(o, self.value * o.value, o.value, self.value)
    }
    fn div(self, o: Self) -> Self {
        let q = self.value / o.value;
        self.chain2(o, q, 1.0 / o.value, -q / o.value)
    }
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
    fn powi(self, n: i32) -> Self {
        let slope = if n == 0 { 0.0 } else { f64::from(n) * self.value.powi(n - 1) };
        self.chain(self.value.powi(n), slope)
    }
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }
    fn tan(self) -> Self {
        let t = self.value.tan();
        self.chain(t, 1.0 + t * t)
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    fn abs(self) -> Self {
        self.chain(self.value.abs(), Number::sign(self.value))
    }
    fn min(self, o: Self) -> Self {
        if o.value < self.value { o } else { self }
    }
    fn max(self, o: Self) -> Self {
        if o.value > self.value { o } else { self }
    }
    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }
    fn sign(self) -> Self {
        Self::constant(Number::sign(self.value))
    }
    fn step(edge: Self, x: Self) -> Self {
        Self::constant(Number::step(edge.value, x.value))
    }
    fn exp2(self) -> Self {
        let value = self.value.exp2();
        self.chain(value, value * std::f64::consts::LN_2)
    }
    fn log2(self) -> Self {
        self.chain(self.value.log2(), std::f64::consts::LOG2_E / self.value)
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        self.chain2(x, self.value.atan2(x.value), x.value / square, -self.value / square)
    }
    fn noise(x: Self, y: Self, z: Self) -> Self {
        let g = noise::value_and_gradient([x.value, y.value, z.value]);
        let d = |k: usize| g[1] * x.derivative[k] + g[2] * y.derivative[k] + g[3] * z.derivative[k];
        Self { value: g[0], derivative: std::array::from_fn(d) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        type F = (fn(f64) -> f64, fn(Dual<1>) -> Dual<1>);
        let cases: [F; 9] = [
            (|x| (3.0 * x).sin(), |x| Dual::constant(3.0).mul(x).sin()),
            (|x| x.cos() / x, |x| x.cos().div(x)),
            (f64::tan, Number::tan),
            (f64::sqrt, Number::sqrt),
            (|x| x.powi(5), |x| x.powi(5)),
            (f64::exp2, Number::exp2),
            (f64::log2, Number::log2),
            (|x| x * x * (3.0 - 2.0 * x), Number::smooth),
            (|x| x.atan2(2.0), |x| x.atan2(Dual::constant(2.0))),
        ];
        for (case, (plain, dual)) in cases.into_iter().enumerate() {
            let x = 0.7;
            let slope = (plain(x + 1e-6) - plain(x - 1e-6)) / 2e-6;
            let got = dual(Dual::new(x, [1.0]));
            assert!((got.value - plain(x)).abs() < 1e-12, "value of case {case}");
            assert!((got.derivative[0] - slope).abs() < 1e-7, "slope of case {case}");
        }
    }
}
