//! Which setting wins at which error, in words.

use displace_server::domain::chart::{Chart, Metric, Point};

/// Two or three digits that count.
pub(crate) fn written(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = (1.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}

/// Of a front, from the fastest to the nearest.
pub(crate) fn front(chart: &Chart, metric: Metric) -> Vec<(&Point, f64)> {
    let on_front = chart.points.iter().filter(|point| point.fronts.contains(&metric));
    let mut front: Vec<_> = on_front.filter_map(|point| Some((point, metric.of(&point.error)?))).collect();
    front.sort_by(|a, b| a.0.ms.total_cmp(&b.0.ms).then(b.1.total_cmp(&a.1)));
    front
}

/// One clause for each winner, settings of one method together.
pub(crate) fn winners(chart: &Chart, metric: Metric, unit: &str) -> String {
    let front = front(chart, metric);
    let mut clauses: Vec<String> = Vec::new();
    let mut k = 0;
    while k < front.len() {
        let method = &front[k].0.method;
        let end = k + front[k..].iter().take_while(|(point, _)| point.method == *method).count();
        let above = if k == 0 { None } else { Some(front[k - 1].1) };
        let (least, most) = (front[end - 1].1, above);
        let range = match most {
            None => format!("allowing {}{unit} or more", written(least)),
            Some(most) => format!("from {} down to {}{unit}", written(most), written(least)),
        };
        let settings: Vec<&str> =
            front[k..end].iter().map(|(point, _)| point.setting.as_str()).filter(|s| !s.is_empty()).collect();
        let settings = if settings.is_empty() { String::new() } else { format!(" ({})", settings.join(", ")) };
        clauses.push(format!(
            "{range} <b>{method}</b>{settings} in {} to {} ms",
            written(front[k].0.ms),
            written(front[end - 1].0.ms)
        ));
        k = end;
    }
    let rest = front.last().map(|(_, error)| format!("; no setting comes below {}{unit}", written(*error)));
    clauses.join("; ") + &rest.unwrap_or_default() + "."
}
