//! Interval dual numbers, with what is known of them (`displace_glsl::expression::interval_jet`).

pub use displace_glsl::expression::interval_jet::{IntervalJet, hull};

#[cfg(test)]
mod tests {
    use displace_glsl::expression::{Dual, Interval, Number};

    use super::*;
    use crate::domain::expression::Program;

    fn box_variables(low: [f64; 2], width: f64) -> [IntervalJet; 8] {
        let one = Interval::constant(1.0);
        let along = |k: usize| {
            let mut slope = [Interval::constant(0.0); 2];
            slope[k] = one;
            IntervalJet::new(Interval::new(low[k], low[k] + width), slope)
        };
        let fixed = IntervalJet::constant(0.3);
        [along(0), along(1), along(0), along(1), fixed, fixed, fixed, fixed]
    }

    fn point_variables(u: f64, v: f64) -> [Dual<2>; 8] {
        let (u, v, fixed) = (Dual::new(u, [1.0, 0.0]), Dual::new(v, [0.0, 1.0]), Dual::constant(0.3));
        [u, v, u, v, fixed, fixed, fixed, fixed]
    }

    #[test]
    fn bounds_hold_values_and_slopes_of_every_function() {
        let sources = [
            "sin(3*u)*cos(2*v)",
            "abs(u-0.5)+min(u,v)*max(u,0.3)",
            "sqrt(u+0.1)/(v+2)",
            "mod(u*3, 0.7)+floor(4*v)",
            "smoothstep(0.2, 0.9, u)*exp(v)",
            "noise(5*u, 5*v, z)+atan2(v, u+0.01)",
            "u^3 - v^2 + tan(u*0.4)+log(u+1.5)",
            "step(0.5, u)+sign(v-0.5)",
        ];
        for source in sources {
            let code = Program::parse(source).unwrap().code;
            for (low, width) in [([0.1, 0.2], 0.3), ([0.45, 0.4], 0.2), ([0.0, 0.0], 1.0), ([0.61, 0.11], 1e-3)] {
                let bound = displace_glsl::expression::evaluate(&code, &box_variables(low, width));
                for k in 0..400 {
                    let (s, t) = (f64::from(k % 20) / 19.0, f64::from(k / 20) / 19.0);
                    let at = point_variables(low[0] + s * width, low[1] + t * width);
                    let point: Dual<2> = displace_glsl::expression::evaluate(&code, &at);
                    assert!(bound.value.contains(point.value), "{source}: {point:?} outside {bound:?}");
                    for axis in 0..2 {
                        let d = point.derivative[axis];
                        assert!(bound.slope[axis].contains(d), "{source}: slope {d} outside {bound:?}");
                    }
                }
            }
        }
    }
}
