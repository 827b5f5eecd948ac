//! Keys of one channel, and what is between them (glTF 2.0, appendix C).

use glam::{DQuat, DVec3, DVec4};

use crate::domain::{
    Error, Result,
    gltf::{json::At, source::Source},
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Between {
    Step,
    Linear,
    /// By Hermite's curves, each key being tangent, value, tangent.
    Cubic,
}

#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Rising, at least one.
    seconds: Vec<f64>,
    /// The fourth is 0 where a key has three. Three for each of `seconds` where they are cubic.
    values: Vec<DVec4>,
    between: Between,
}

impl Track {
    pub(super) fn read(source: &Source<'_>, animation: &At<'_>, channel: &At<'_>, components: usize) -> Result<Self> {
        let count = animation.count("samplers")?;
        let sampler = animation.element("samplers", channel.need("sampler")?.index_here(count, "samplers")?)?;
        let between = match sampler.text("interpolation")?.unwrap_or("LINEAR") {
            "STEP" => Between::Step,
            "LINEAR" => Between::Linear,
            "CUBICSPLINE" => Between::Cubic,
            other => return Err(sampler.error(format!("interpolation '{other}' is none of LINEAR, STEP, CUBICSPLINE"))),
        };
        let (input, output) = (sampler.need("input")?, sampler.need("output")?);
        let (times, keys) = (source.accessor(&input)?, source.accessor(&output)?);
        let each = if between == Between::Cubic { 3 } else { 1 };
        if times.components() != 1 || keys.components() != components || keys.count != each * times.count {
            let message = format!(
                "has keys of {} components, {} for {} times; {components} are needed, {each} for each",
                keys.components(),
                keys.count,
                times.count
            );
            return Err(sampler.error(message));
        }
        let values = keys.floats(source)?;
        let values = values.chunks_exact(components).map(vector).collect();
        Self::new(times.floats(source)?, values, between).ok_or_else(|| rising(&input))
    }

    fn new(seconds: Vec<f32>, values: Vec<DVec4>, between: Between) -> Option<Self> {
        let seconds: Vec<f64> = seconds.into_iter().map(f64::from).collect();
        let sound = !seconds.is_empty() && seconds.is_sorted_by(|a, b| a < b) && seconds.iter().all(|s| s.is_finite());
        let finite = values.iter().all(|value| value.is_finite());
        (sound && finite).then_some(Self { seconds, values, between })
    }

    /// Of the first and the last key.
    pub(super) fn seconds(&self) -> [f64; 2] {
        [self.seconds[0], self.seconds[self.seconds.len() - 1]]
    }

    pub(super) fn vector(&self, seconds: f64) -> DVec3 {
        self.at(seconds, DVec4::lerp).truncate()
    }

    pub(super) fn rotation(&self, seconds: f64) -> DQuat {
        let turned = |a: DVec4, b: DVec4, share: f64| {
            DVec4::from(DQuat::from_vec4(unit(a)).slerp(DQuat::from_vec4(unit(b)), share))
        };
        DQuat::from_vec4(unit(self.at(seconds, turned)))
    }

    /// The ends hold before the first key and after the last one.
    fn at(&self, seconds: f64, linear: impl Fn(DVec4, DVec4, f64) -> DVec4) -> DVec4 {
        let next = self.seconds.partition_point(|key| *key <= seconds);
        let value = |key: usize| self.values[if self.between == Between::Cubic { 3 * key + 1 } else { key }];
        let Some(last) = next.checked_sub(1) else { return value(0) };
        if next == self.seconds.len() {
            return value(last);
        }
        let length = self.seconds[next] - self.seconds[last];
        let share = (seconds - self.seconds[last]) / length;
        match self.between {
            Between::Step => value(last),
            Between::Linear => linear(value(last), value(next), share),
            Between::Cubic => {
                let (leaving, coming) = (length * self.values[3 * last + 2], length * self.values[3 * next]);
                hermite([value(last), leaving, value(next), coming], share)
            }
        }
    }
}

fn vector(components: &[f32]) -> DVec4 {
    let component = |k: usize| components.get(k).copied().map_or(0.0, f64::from);
    DVec4::new(component(0), component(1), component(2), component(3))
}

fn unit(rotation: DVec4) -> DVec4 {
    rotation.normalize_or(DVec4::W)
}

/// Start, tangent there, end, tangent there.
fn hermite([from, leaving, to, coming]: [DVec4; 4], t: f64) -> DVec4 {
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * from + (t3 - 2.0 * t2 + t) * leaving + (3.0 * t2 - 2.0 * t3) * to + (t3 - t2) * coming
}

fn rising(input: &At<'_>) -> Error {
    input.error("has times that do not rise, or a key that is no number")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(between: Between, values: &[[f64; 4]]) -> Track {
        Track::new(vec![1.0, 3.0], values.iter().copied().map(DVec4::from_array).collect(), between).unwrap()
    }

    #[test]
    fn keys_hold_step_or_blend() {
        let values = [[0.0, 0.0, 0.0, 0.0], [4.0, 2.0, 0.0, 0.0]];
        let (step, linear) = (track(Between::Step, &values), track(Between::Linear, &values));
        for (seconds, stepped, blended) in
            [(0.0, 0.0, 0.0), (1.5, 0.0, 1.0), (2.5, 0.0, 3.0), (3.0, 4.0, 4.0), (9.0, 4.0, 4.0)]
        {
            assert_eq!(step.vector(seconds).x, stepped, "{seconds} s");
            assert!((linear.vector(seconds).x - blended).abs() < 1e-12, "{seconds} s");
        }
        assert_eq!(linear.seconds(), [1.0, 3.0]);
    }

    #[test]
    fn a_cubic_follows_its_tangents() {
        // x = t^2 of the time since the first key, whose tangents are 0 and 4.
        let zero = [0.0; 4];
        let cubic = track(Between::Cubic, &[zero, zero, zero, [4.0, 0.0, 0.0, 0.0], [4.0, 0.0, 0.0, 0.0], zero]);
        for t in [0.0, 0.3, 1.0, 1.7, 2.0] {
            assert!((cubic.vector(1.0 + t).x - t * t).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn rotations_turn_evenly_the_short_way() {
        let turn = |degrees: f64| DVec4::from(DQuat::from_rotation_y(degrees.to_radians()));
        let values = [turn(0.0), -turn(120.0)].map(|q| q.to_array());
        let linear = track(Between::Linear, &values);
        let found = linear.rotation(1.5) * DVec3::Z;
        assert!(found.distance(DQuat::from_rotation_y(30f64.to_radians()) * DVec3::Z) < 1e-9, "{found}");
    }

    #[test]
    fn times_rise() {
        assert!(Track::new(vec![1.0, 1.0], vec![DVec4::ZERO; 2], Between::Linear).is_none());
        assert!(Track::new(vec![], vec![], Between::Linear).is_none());
        assert!(Track::new(vec![0.0], vec![DVec4::NAN], Between::Linear).is_none());
    }
}
