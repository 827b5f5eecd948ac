//! The points: their courses, the front, the automatic choice, and names as far as there is room.

use std::fmt::Write as _;

use super::{
    PLOT, Plot,
    labels::{Rect, along, halo_at, mark_at, placed},
    marks::{halo, mark},
    rounded, what,
};
use crate::{domain::chart::Point, jobs::chart::page::escaped};

impl Plot<'_> {
    /// A thin line through the settings of each method, in their order.
    pub(super) fn courses(&self, svg: &mut String) {
        let mut last: Option<(&Point, [f64; 2])> = None;
        for (_, point, place) in self.shown() {
            let goes_on =
                |known: &Point| known.method == point.method && sweep(known).is_some() && sweep(known) == sweep(point);
            if let Some((_, [x, y])) = last.filter(|(known, _)| goes_on(known)) {
                let (color, [to_x, to_y]) = (mark(&point.method).color, place);
                let _ = writeln!(
                    svg,
                    "<path fill=\"none\" stroke=\"{color}\" stroke-opacity=\".35\" d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\"/>"
                );
            }
            last = Some((point, place));
        }
    }

    /// Nothing lies below and left of it.
    pub(super) fn front(&self, svg: &mut String) {
        let front = self.on_front();
        let Some((_, [x, y])) = front.first() else { return };
        let mut path = format!("M{x:.1} {}V{y:.1}", PLOT[1]);
        for (_, [x, y]) in &front[1..] {
            let _ = write!(path, "H{x:.1}V{y:.1}");
        }
        let _ = writeln!(
            svg,
            "<path class=\"front\" fill=\"none\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\" d=\"{path}H{}\"/>",
            PLOT[2]
        );
    }

    pub(super) fn points(&self, svg: &mut String) {
        for (k, point, place) in self.shown() {
            let error = self.metric.of(&point.error).unwrap_or_default();
            let told = format!("{}: {:.2} ms, {} {}", point.label(), point.ms, what(self.metric), rounded(error));
            let (told, name) = (escaped(&told), escaped(&point.name));
            let shape = shape(&point.method, place);
            let _ = writeln!(
                svg,
                "<a href=\"{name}.png\" aria-label=\"{told}\" data-point=\"{k}\"><title>{told}</title>{shape}</a>"
            );
        }
    }

    /// A star around the automatic choice.
    pub(super) fn choice(&self, svg: &mut String) {
        for (_, _, place) in self.shown().filter(|(_, point, _)| point.chosen) {
            let _ = writeln!(svg, "<path class=\"chosen\" d=\"{}\"/>", halo(place));
        }
    }

    pub(super) fn labels(&self, svg: &mut String) {
        let front = self.on_front();
        let mut taken: Vec<Rect> = self.shown().map(|(_, _, place)| mark_at(place)).collect();
        let chosen = self.shown().find(|(_, point, _)| point.chosen).map(|(_, point, place)| (point, place));
        taken.extend(chosen.map(|(_, place)| halo_at(place)));
        if let (Some((_, [x, y])), Some((_, [last_x, last_y]))) = (front.first(), front.last()) {
            taken.extend([along([*x, PLOT[1]], [*x, *y]), along([*last_x, *last_y], [PLOT[2], *last_y])]);
        }
        for pair in front.windows(2) {
            let ([x0, y0], [x1, y1]) = (pair[0].1, pair[1].1);
            taken.extend([along([x0, y0], [x1, y0]), along([x1, y0], [x1, y1])]);
        }
        let off_front = chosen.filter(|(point, _)| !point.fronts.contains(&self.metric));
        let named = off_front.iter().chain(&front);
        let wanted = named.map(|(point, place)| (point.label(), *place)).collect();
        for label in placed(wanted, taken, PLOT) {
            if let Some([x0, y0, x1, y1]) = label.leader {
                let _ =
                    writeln!(svg, "<path class=\"frame\" stroke-width=\".7\" d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\"/>");
            }
            let (x, y) = (label.rect[0] + 1.0, label.rect[3] - 3.5);
            let _ = writeln!(svg, "<text class=\"ink\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(&label.text));
        }
    }
}

/// What of numbers a setting is one of.
fn sweep(point: &Point) -> Option<&str> {
    point
        .setting
        .contains(|c: char| c.is_ascii_digit())
        .then(|| point.setting.trim_matches(|c: char| c.is_ascii_digit() || c == '.'))
}

pub(super) fn shape(method: &str, [x, y]: [f64; 2]) -> String {
    let mark = mark(method);
    let (path, color) = (mark.path(x, y), mark.color);
    if mark.filled {
        return format!("<path fill=\"{color}\" d=\"{path}\"/>");
    }
    format!("<path class=\"paper\" stroke=\"{color}\" stroke-width=\"2\" d=\"{path}\"/>")
}
