//! What the table says of itself, and what is written.

use super::{table::TABLE, *};
use crate::domain::stability::{Violation, Worse};

#[test]
fn no_two_scenarios_share_a_file_and_each_tells_what_fails_and_what_is_published() {
    for (k, row) in TABLE.iter().enumerate() {
        assert!(TABLE[..k].iter().all(|other| other.name != row.name), "{}", row.name);
        assert!(row.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", row.name);
        let sentences = row.story.split(". ").count();
        assert!((2..=5).contains(&sentences) && row.story.ends_with('.'), "{}: {sentences}", row.name);
        assert!(!row.literature.is_empty(), "{}", row.name);
    }
}

fn scenario() -> Scenario {
    let curve = |method: &str, values: &[[f64; 2]], breakdown| Curve {
        method: method.into(),
        values: values.to_vec(),
        breakdown,
        literature: "<b> & more".into(),
    };
    Scenario {
        name: "one".into(),
        title: "a <i>".into(),
        unit: "degrees".into(),
        metric: "error".into(),
        metric_unit: "px".into(),
        line: 1.0,
        worse: Worse::Upwards,
        curves: vec![
            curve("flat, or less", &[[1.0, 0.5], [2.0, 2.0]], Some(1.0 + 1.0 / 3.0)),
            curve("exact", &[[1.0, 0.0]], None),
        ],
        violations: vec![Violation { rule: "finite".into(), count: 3, first: "<s>".into() }],
        ..Scenario::default()
    }
}

fn suite() -> Stability {
    Stability { title: "<u>".into(), device: "<q>".into(), scenarios: vec![scenario()], ..Stability::default() }
}

#[test]
fn the_table_has_a_row_for_each_value_and_what_never_breaks_is_empty() {
    let text = written::csv(&suite());
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[1], "one,\"flat, or less\",1,degrees,error (px),0.5,1,1.33333");
    assert_eq!(lines[3], "one,exact,1,degrees,error (px),0,1,");
    assert_eq!(lines.len(), 4);
}

#[test]
fn words_from_outside_cannot_become_markup_and_a_broken_rule_is_told_on_the_page() {
    let page = page::html(&suite());
    for markup in ["<i>", "<u>", "<q>", "<s>", "<b>"] {
        assert!(!page.contains(markup), "{markup}");
    }
    assert!(page.contains("finite did not hold 3 times, first: &lt;s&gt;") && page.contains("3 of 0 checks"), "{page}");
}

#[test]
fn a_broken_rule_is_a_warning_with_the_name_of_its_scenario() {
    let left_out = Scenario { name: "two".into(), left_out: Some("no device".into()), ..Scenario::default() };
    let stability = Stability { scenarios: vec![scenario(), left_out], ..Stability::default() };
    let told: Vec<String> = warnings(&stability).into_iter().map(|w| format!("{}: {}", w.code, w.message)).collect();
    assert_eq!(
        told,
        ["invariant_broken: one: finite did not hold 3 times, first <s>", "left_out: two is not measured: no device"]
    );
}
