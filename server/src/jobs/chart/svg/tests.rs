//! What is drawn of a chart, and what cannot get into it.

use super::*;
use crate::domain::report::Comparison;

fn point(method: &str, setting: &str, ms: f64, flip_mean: f64) -> Point {
    let error = Comparison { flip_mean, hit_error_px: Some(flip_mean), ..Comparison::default() };
    Point {
        name: format!("{method}-{setting}"),
        method: method.into(),
        setting: setting.into(),
        ms,
        error,
        ..Point::default()
    }
}

fn chart() -> Chart {
    let mut points = vec![
        point("flat", "", 1.0, 0.3),
        point("relief", "16", 4.0, 0.1),
        point("relief", "32", 7.0, 0.1),
        point("exact", "", 9.0, 0.0),
    ];
    super::super::pareto::mark(&mut points);
    Chart { title: "a <b> & \"c\"".into(), device: "<device>".into(), points, ..Chart::default() }
}

#[test]
fn names_from_outside_cannot_become_markup() {
    let svg = document(&chart(), Metric::Flip);
    assert!(svg.contains("a &lt;b&gt; &amp; &quot;c&quot;") && svg.contains("&lt;device&gt;"), "{svg}");
    assert!(!svg.contains("<b>") && !svg.contains("<device>"));
}

#[test]
fn every_point_is_a_link_to_its_image_and_those_on_the_front_have_labels() {
    let svg = document(&chart(), Metric::Flip);
    for (k, name) in ["flat-", "relief-16", "relief-32", "exact-"].iter().enumerate() {
        assert!(
            svg.contains(&format!("<a href=\"{name}.png\"")) && svg.contains(&format!("data-point=\"{k}\"")),
            "{name}"
        );
    }
    assert!(svg.contains(">relief 16</text>") && !svg.contains(">relief 32</text>"));
}

#[test]
fn what_has_no_error_of_a_kind_is_not_in_its_chart() {
    let svg = document(&chart(), Metric::SilhouettePx);
    assert!(!svg.contains("data-point"), "{svg}");
}

#[test]
fn figures_have_three_digits() {
    assert_eq!([0.0, 0.012_345_6, 1.0, 1234.5, 99.999].map(rounded), ["0", "0.0123", "1.00", "1234", "100.0"]);
}
