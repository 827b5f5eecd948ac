//! Where labels stand: beside their points, over nothing else.

use super::marks::{HALO, RADIUS};

/// Sides of a rectangle: left, top, right, bottom.
pub(super) type Rect = [f64; 4];

/// Of a letter, and of a line of them, pixels.
const LETTER: f64 = 6.4;
const LINE: f64 = 14.0;
/// From a point to its label, tried in this order.
const REACHES: [f64; 4] = [10.0, 20.0, 34.0, 52.0];

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) text: String,
    pub(super) rect: Rect,
    /// From the point to the label, where it stands away.
    pub(super) leader: Option<[f64; 4]>,
}

/// Labels of points, as far as there is room within `frame`. `taken` is what else must not be covered.
pub(super) fn placed(wanted: Vec<(String, [f64; 2])>, taken: Vec<Rect>, frame: Rect) -> Vec<Label> {
    let mut taken = taken;
    let mut labels = Vec::new();
    for (text, point) in wanted {
        let free = candidates(&text, point).into_iter().find(|(rect, _)| is_free(rect, &taken, frame));
        let Some((rect, is_away)) = free else { continue };
        taken.push(rect);
        labels.push(Label { text, rect, leader: is_away.then(|| leader(point, rect)) });
    }
    labels
}

/// Around the point, nearest first, and whether it stands away from it.
fn candidates(text: &str, [x, y]: [f64; 2]) -> Vec<(Rect, bool)> {
    let (w, h) = (LETTER * text.chars().count() as f64 + 2.0, LINE);
    let around = |reach: f64| {
        let slant = 0.75 * reach;
        [
            [x + reach, y - 0.5 * h],
            [x + slant, y - slant - 0.5 * h],
            [x + slant, y + slant - 0.5 * h],
            [x - 0.5 * w, y - reach - h],
            [x - 0.5 * w, y + reach],
            [x - reach - w, y - 0.5 * h],
            [x - slant - w, y - slant - 0.5 * h],
            [x - slant - w, y + slant - 0.5 * h],
        ]
    };
    let rects = REACHES.into_iter().enumerate().flat_map(|(k, reach)| around(reach).map(|place| (place, k > 0)));
    rects.map(|([left, top], is_away)| ([left, top, left + w, top + h], is_away)).collect()
}

fn is_free(rect: &Rect, taken: &[Rect], frame: Rect) -> bool {
    let inside = rect[0] >= frame[0] && rect[1] >= frame[1] && rect[2] <= frame[2] && rect[3] <= frame[3];
    inside && !taken.iter().any(|other| overlap(rect, other))
}

pub(super) fn overlap(a: &Rect, b: &Rect) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// What a point's mark covers.
pub(super) fn mark_at([x, y]: [f64; 2]) -> Rect {
    let r = RADIUS + 2.0;
    [x - r, y - r, x + r, y + r]
}

/// What the star around the automatic choice covers.
pub(super) fn halo_at([x, y]: [f64; 2]) -> Rect {
    [x - HALO, y - HALO, x + HALO, y + HALO]
}

/// What a line that goes along an axis covers.
pub(super) fn along([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Rect {
    [x0.min(x1) - 1.0, y0.min(y1) - 1.0, x0.max(x1) + 1.0, y0.max(y1) + 1.0]
}

/// To the nearest place of the label.
fn leader([x, y]: [f64; 2], rect: Rect) -> [f64; 4] {
    [x, y, x.clamp(rect[0], rect[2]), y.clamp(rect[1], rect[3])]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FRAME: Rect = [0.0, 0.0, 600.0, 400.0];

    proptest! {
        #[test]
        fn labels_cover_neither_each_other_nor_marks(places in prop::collection::vec([0.0..600.0f64, 0.0..400.0], 0..40)) {
            let taken: Vec<Rect> = places.iter().map(|place| mark_at(*place)).collect();
            let wanted = places.iter().enumerate().map(|(k, place)| (format!("label {k}"), *place)).collect();
            let labels = placed(wanted, taken.clone(), FRAME);
            for (k, label) in labels.iter().enumerate() {
                prop_assert!(!taken.iter().any(|mark| overlap(mark, &label.rect)));
                prop_assert!(!labels[..k].iter().any(|other| overlap(&other.rect, &label.rect)));
                prop_assert!(is_free(&label.rect, &[], FRAME));
            }
        }
    }

    #[test]
    fn one_point_has_its_label_beside_it() {
        let labels = placed(vec![("exact".into(), [50.0, 50.0])], vec![mark_at([50.0, 50.0])], FRAME);
        assert_eq!((labels[0].rect[0], labels[0].leader), (60.0, None));
    }

    #[test]
    fn where_there_is_no_room_there_is_no_label() {
        assert!(placed(vec![("exact".into(), [50.0, 50.0])], vec![FRAME], FRAME).is_empty());
    }
}
