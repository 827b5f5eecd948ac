//! The grid that positions are quantised on: one for all primitives of a mesh, so that equal places stay equal.

/// The same step along every axis, so that directions stay what they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Where the grid begins, mesh-local units: the lowest corner of the box, and of the f32 numbers.
    pub offset: [f32; 3],
    /// Mesh-local units; above 0.
    pub step: f32,
}

/// Steps along the longest side.
const STEPS: f64 = u16::MAX as f64;

impl Grid {
    /// The finest that holds all positions, which are finite; where they are one place, or none, that place alone.
    #[must_use]
    pub fn around(positions: &[[f32; 3]]) -> Self {
        let [low, high] = bounds(positions).unwrap_or_default();
        let longest = (0..3).map(|k| f64::from(high[k]) - f64::from(low[k])).fold(0.0, f64::max);
        Self { offset: low, step: step(longest) }
    }

    /// The nearest node.
    #[must_use]
    pub fn place(&self, position: [f32; 3]) -> [u16; 3] {
        let steps = |k: usize| (f64::from(position[k]) - f64::from(self.offset[k])) / f64::from(self.step);
        [0, 1, 2].map(|k| steps(k).round().clamp(0.0, STEPS) as u16)
    }

    /// Where a node lies, mesh-local units.
    #[must_use]
    pub fn position(&self, place: [u16; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| f64::from(self.offset[k]) + f64::from(place[k]) * f64::from(self.step))
    }

    /// The farthest that any position is moved, mesh-local units: half a step along each axis.
    #[must_use]
    pub fn error_local(&self) -> f64 {
        0.5 * 3f64.sqrt() * f64::from(self.step)
    }

    /// That of a grid over a box whose longest side is given.
    #[must_use]
    pub fn error_over(longest_local: f64) -> f64 {
        0.5 * 3f64.sqrt() * f64::from(step(longest_local))
    }
}

/// Rounded up, so that the last node is not before the end.
fn step(longest: f64) -> f32 {
    let exact = longest / STEPS;
    let step = exact as f32;
    let step = if f64::from(step) < exact { step.next_up() } else { step };
    // Devices take smaller ones for 0.
    step.max(f32::MIN_POSITIVE)
}

fn bounds(positions: &[[f32; 3]]) -> Option<[[f32; 3]; 2]> {
    let each = positions.iter().map(|p| [*p, *p]);
    each.reduce(|[low, high], [p, _]| [[0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k]))])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn no_position_moves_farther_than_the_error(
            positions in proptest::collection::vec([-1e3f32..1e3, -1.0f32..1.0, 5.0f32..6.0], 1..50),
        ) {
            let grid = Grid::around(&positions);
            for position in positions {
                let node = grid.position(grid.place(position));
                let moved = (0..3).map(|k| (node[k] - f64::from(position[k])).powi(2)).sum::<f64>().sqrt();
                prop_assert!(moved <= grid.error_local() * (1.0 + 1e-12), "{position:?} to {node:?}");
            }
        }
    }

    #[test]
    fn the_box_spans_the_grid_from_its_first_node_to_its_last() {
        let grid = Grid::around(&[[1.0, 2.0, 3.0], [4.0, 2.5, 3.0]]);
        assert_eq!(grid.place([1.0, 2.0, 3.0]), [0, 0, 0]);
        assert_eq!(grid.place([4.0, 2.0, 3.0]), [65535, 0, 0]);
        assert_eq!(grid.position([0, 0, 0]), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn one_place_keeps_its_position() {
        let place = [0.1, -3e7, 2e-30];
        let grid = Grid::around(&[place, place]);
        assert_eq!(grid.position(grid.place(place)), place.map(f64::from));
    }

    #[test]
    fn the_error_is_known_from_the_longest_side() {
        let grid = Grid::around(&[[0.0; 3], [0.25, 3.0, 1.0]]);
        assert_eq!(grid.error_local(), Grid::error_over(3.0));
        assert!((grid.error_local() / (3.0 * 3f64.sqrt() / 131_070.0) - 1.0).abs() < 1e-6);
    }
}
