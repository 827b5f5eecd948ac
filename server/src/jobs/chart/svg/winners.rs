//! Beside the axis of errors: the fastest setting that is as near, at every error.

use std::fmt::Write as _;

use super::{PLOT, Plot, marks::mark};
use crate::jobs::chart::page::escaped;

/// Sides of the strip, and where names begin.
const STRIP: [f64; 2] = [PLOT[2] + 8.0, PLOT[2] + 18.0];
const NAMES_X: f64 = PLOT[2] + 38.0;
/// Of names, pixels.
const LINE: f64 = 14.0;

impl Plot<'_> {
    pub(super) fn winners(&self, svg: &mut String) {
        let front = self.on_front();
        let places: Vec<f64> = front.iter().map(|(_, [_, y])| *y).collect();
        let from = [PLOT[1]].into_iter().chain(places.iter().copied());
        let spans: Vec<[f64; 2]> = from.zip(&places).map(|(from, to)| [from, *to]).collect();
        let lines = apart(&spans.iter().map(|[from, to]| 0.5 * (from + to)).collect::<Vec<_>>());
        let [left, right] = STRIP;
        let _ = writeln!(svg, "<text class=\"soft\" x=\"{left}\" y=\"{}\">fastest within it</text>", PLOT[1] - 6.0);
        for (((point, _), [from, to]), line) in front.iter().zip(&spans).zip(lines) {
            let (color, name) = (mark(&point.method).color, escaped(&point.label()));
            let (height, middle) = ((to - from).max(1.0), 0.5 * (from + to));
            let _ = writeln!(
                svg,
                "<rect class=\"winner\" x=\"{left}\" y=\"{from:.1}\" width=\"{}\" height=\"{height:.1}\" fill=\"{color}\"/>\
                 <path class=\"frame\" fill=\"none\" stroke-width=\".7\" d=\"M{right} {middle:.1}L{} {line:.1}\"/>\
                 <text class=\"ink\" x=\"{NAMES_X}\" y=\"{:.1}\">{name}</text>",
                right - left,
                NAMES_X - 4.0,
                line + 4.0
            );
        }
    }
}

/// Rising places, moved so that names on them do not overlap, within the plot.
fn apart(places: &[f64]) -> Vec<f64> {
    let [top, bottom] = [PLOT[1] + 0.5 * LINE, PLOT[3] - 0.5 * LINE];
    let line = LINE.min((bottom - top) / places.len().saturating_sub(1).max(1) as f64);
    let mut lines = places.to_vec();
    let mut least = top;
    for place in &mut lines {
        *place = place.max(least);
        least = *place + line;
    }
    let mut most = bottom;
    for place in lines.iter_mut().rev() {
        *place = place.min(most);
        most = *place - line;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lie_in_their_order_apart_and_within_the_plot() {
        for places in [vec![100.0], vec![100.0, 100.0, 101.0], vec![470.0; 5], (0..29).map(|_| 300.0).collect()] {
            let lines = apart(&places);
            assert!(lines.windows(2).all(|pair| pair[1] - pair[0] > LINE - 1e-9), "{lines:?}");
            assert!(lines[0] >= PLOT[1] && lines[lines.len() - 1] <= PLOT[3], "{lines:?}");
        }
        assert_eq!(apart(&[100.0, 300.0]), [100.0, 300.0], "where there is room names are beside what they name");
    }
}
