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
    let svg = element(&chart(), Metric::Flip);
    assert!(svg.contains("a &lt;b&gt; &amp; &quot;c&quot;") && svg.contains("&lt;device&gt;"), "{svg}");
    assert!(!svg.contains("<b>") && !svg.contains("<device>"));
}

#[test]
fn every_point_is_a_link_to_its_image_and_those_on_the_front_have_labels() {
    let svg = element(&chart(), Metric::Flip);
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
    let svg = element(&chart(), Metric::SilhouettePx);
    assert!(!svg.contains("data-point"), "{svg}");
}

#[test]
fn the_file_has_a_drawing_for_each_error_that_is_known() {
    let svg = document(&chart());
    for known in ["FLIP against time", "hit error against time"] {
        assert!(svg.contains(&format!("aria-label=\"{known}")), "{known}");
    }
    assert!(!svg.contains("outline error against time"));
    assert_eq!(svg.matches("data-point=\"3\"").count(), 2);
}

#[test]
fn the_automatic_choice_has_a_star_and_its_distance_from_the_front() {
    let mut chart = chart();
    assert!(!element(&chart, Metric::Flip).contains("the automatic choice"));
    chart.points[2].chosen = true;
    let svg = element(&chart, Metric::Flip);
    assert_eq!(svg.matches("<path class=\"chosen\"").count(), 2, "at the point, and in the legend");
    assert!(svg.contains("1.75 x the front") && svg.contains(">relief 32</text>"), "7 ms, where 4 ms are as near");
    assert_eq!(chart.times_front(Metric::SilhouettePx), None);
    (chart.points[2].chosen, chart.points[3].chosen) = (false, true);
    assert!(element(&chart, Metric::Flip).contains("on the front"));
}

#[test]
fn figures_have_three_digits() {
    assert_eq!([0.0, 0.012_345_6, 1.0, 1234.5, 99.999].map(rounded), ["0", "0.0123", "1.00", "1234", "100.0"]);
}
