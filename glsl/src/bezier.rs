//! Bézier triangles: polynomials over a triangle by their control nets (Farin 2002).

use glam::DVec3;

/// Control points of the largest net: degree 6.
const MOST_POINTS: usize = 28;

/// A polynomial in the barycentrics of a triangle. Point (j, k) stands for the blossom at corner 0 degree − j − k times,
/// corner 1 j times and corner 2 k times; rows of constant k follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Net {
    pub degree: usize,
    points: [DVec3; MOST_POINTS],
}

/// Value, first and second derivatives along b1 and b2: (11, 12, 22).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondJet {
    pub value: DVec3,
    pub first: [DVec3; 2],
    pub second: [DVec3; 3],
}

/// How many points a net of this degree has.
#[must_use]
pub const fn points(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Number of point (j, k).
#[must_use]
pub const fn index(degree: usize, j: usize, k: usize) -> usize {
    k * (degree + 1) - k * k.saturating_sub(1) / 2 + j
}

/// All (j, k), in order.
pub fn indices(degree: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=degree).flat_map(move |k| (0..=degree - k).map(move |j| (j, k)))
}

impl Net {
    /// `point(j, k)` is that control point; the degree is at most 6.
    #[must_use]
    pub fn new(degree: usize, mut point: impl FnMut(usize, usize) -> DVec3) -> Self {
        let mut net = Self { degree, points: [DVec3::ZERO; MOST_POINTS] };
        indices(degree).for_each(|(j, k)| net.points[index(degree, j, k)] = point(j, k));
        net
    }

    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points[..points(self.degree)]
    }

    #[must_use]
    pub fn point(&self, j: usize, k: usize) -> DVec3 {
        self.points[index(self.degree, j, k)]
    }

    /// One step of de Casteljau's algorithm, with any coefficients.
    fn step(&self, c: DVec3) -> Self {
        let mut net = *self;
        net.reduce(c);
        net
    }

    #[must_use]
    pub fn at(&self, b: DVec3) -> DVec3 {
        let mut net = *self;
        (0..self.degree).for_each(|_| net.reduce(b));
        net.points[0]
    }

    /// As `step`, in place.
    fn reduce(&mut self, c: DVec3) {
        let degree = self.degree;
        let (mut from, mut to) = (0, 0);
        for k in 0..degree {
            for _ in 0..degree - k {
                let above = self.points[from + degree + 1 - k];
                self.points[to] = self.points[from] * c.x + self.points[from + 1] * c.y + above * c.z;
                (from, to) = (from + 1, to + 1);
            }
            from += 1;
        }
        self.degree = degree - 1;
    }

    /// For degrees from 2 on.
    #[must_use]
    pub fn second_jet(&self, b: DVec3) -> SecondJet {
        let d = self.degree as f64;
        let q = (2..self.degree).fold(*self, |net, _| net.step(b));
        let l = q.step(b);
        let p = |j, k| q.point(j, k);
        let scale = d * (d - 1.0);
        let second = [
            p(2, 0) - 2.0 * p(1, 0) + p(0, 0),
            p(1, 1) - p(1, 0) - p(0, 1) + p(0, 0),
            p(0, 2) - 2.0 * p(0, 1) + p(0, 0),
        ];
        SecondJet {
            value: l.step(b).points[0],
            first: [d * (l.point(1, 0) - l.point(0, 0)), d * (l.point(0, 1) - l.point(0, 0))],
            second: second.map(|v| v * scale),
        }
    }

    /// The derivative along a direction, as differences of barycentrics.
    #[must_use]
    pub fn along(&self, direction: DVec3) -> Self {
        if self.degree == 0 {
            return Self::new(0, |_, _| DVec3::ZERO);
        }
        self.step(direction * self.degree as f64)
    }

    /// The same polynomial over the triangle with these corners: the blossom at them.
    #[must_use]
    pub fn within(&self, corners: [DVec3; 3]) -> Self {
        let mut part = *self;
        let mut by_last = *self;
        for k in 0..=self.degree {
            let mut by_both = by_last;
            for j in 0..=self.degree - k {
                let mut net = by_both;
                (0..self.degree - j - k).for_each(|_| net.reduce(corners[0]));
                part.points[index(self.degree, j, k)] = net.points[0];
                if j + k < self.degree {
                    by_both.reduce(corners[1]);
                }
            }
            if k < self.degree {
                by_last.reduce(corners[2]);
            }
        }
        part
    }

    /// The cross product; degrees add up, to 6 at most.
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        let degree = self.degree + other.degree;
        let mut sum = Self::new(degree, |_, _| DVec3::ZERO);
        for (j, k) in indices(self.degree) {
            for (m, n) in indices(other.degree) {
                let weight = multinomial(self.degree, j, k) * multinomial(other.degree, m, n);
                let product = self.point(j, k).cross(other.point(m, n)) * weight;
                sum.points[index(degree, j + m, k + n)] += product / multinomial(degree, j + m, k + n);
            }
        }
        sum
    }

    /// What is straight between `corners`, taken away.
    #[must_use]
    pub fn less(&self, corners: [DVec3; 3]) -> Self {
        let d = (self.degree as f64).max(1.0);
        Self::new(self.degree, |j, k| {
            let (y, z) = (j as f64 / d, k as f64 / d);
            self.point(j, k) - (corners[0] * (1.0 - y - z) + corners[1] * y + corners[2] * z)
        })
    }

    /// No value is longer: a polynomial stays within the hull of its net.
    #[must_use]
    pub fn longest(&self) -> f64 {
        self.points().iter().fold(0.0, |most: f64, p| most.max(p.length()))
    }

    /// Values at the corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 3] {
        [self.point(0, 0), self.point(self.degree, 0), self.point(0, self.degree)]
    }
}

fn multinomial(degree: usize, j: usize, k: usize) -> f64 {
    const FACTORIALS: [f64; 7] = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0];
    FACTORIALS[degree] / (FACTORIALS[degree - j - k] * FACTORIALS[j] * FACTORIALS[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// b0² b1 + 2 b2³, b1 b2², b0³ as a cubic.
    fn cubic() -> Net {
        Net::new(3, |j, k| match (j, k) {
            (1, 0) => DVec3::X / 3.0,
            (0, 3) => DVec3::X * 2.0,
            (1, 2) => DVec3::Y / 3.0,
            (0, 0) => DVec3::Z,
            _ => DVec3::ZERO,
        })
    }

    const B: DVec3 = DVec3::new(0.5, 0.2, 0.3);

    #[test]
    fn a_net_has_the_values_and_slopes_of_its_polynomial() {
        let jet = cubic().second_jet(B);
        let value = DVec3::new(0.25 * 0.2 + 2.0 * 0.027, 0.2 * 0.09, 0.125);
        assert!(jet.value.distance(value) < 1e-15 && cubic().at(B).distance(value) < 1e-15);
        let by_b1 = DVec3::new(0.25 - 2.0 * 0.5 * 0.2, 0.09, -0.75);
        assert!(jet.first[0].distance(by_b1) < 1e-14, "{:?}", jet.first);
        let by_both = DVec3::new(-2.0 * 0.5 + 2.0 * 0.2, 2.0 * 0.3, 3.0);
        assert!(jet.second[1].distance(by_both) < 1e-14, "{:?}", jet.second);
        let derived = cubic().along(DVec3::new(-1.0, 1.0, 0.0)).at(B);
        assert!(derived.distance(by_b1) < 1e-14);
    }

    #[test]
    fn a_part_of_a_net_is_the_same_polynomial() {
        let corners = [DVec3::new(0.5, 0.25, 0.25), DVec3::new(0.25, 0.75, 0.0), DVec3::new(0.0, 0.25, 0.75)];
        let place = corners[0] * B.x + corners[1] * B.y + corners[2] * B.z;
        assert!(cubic().within(corners).at(B).distance(cubic().at(place)) < 1e-15);
        let squares = cubic().cross(&Net::new(1, |j, k| DVec3::new(1.0, j as f64, k as f64)));
        let expected = cubic().at(B).cross(DVec3::new(1.0, B.y, B.z));
        assert!(squares.degree == 4 && squares.at(B).distance(expected) < 1e-15);
    }
}
