//! Predicted beside measured errors, method by method.

use std::fmt::Write as _;

use displace_server::domain::chart::Candidate;

use super::measure::{Trial, trials};

/// Pixels: ratios to less say nothing.
pub const FLOOR_PX: f64 = 0.05;
/// Of 32-bit heights and rays.
const ROUNDING_PX: f64 = 1e-3;

#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub seed: u64,
    pub trial: Trial,
    pub predicted_px: f64,
    pub measured_px: f64,
    /// Of a ray; 0 where nothing is marched.
    pub expected_fetches: f64,
    pub fetches: f64,
}

pub struct Rows {
    pub rows: Vec<Row>,
}

/// Of one method by one setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    pub trial: Trial,
    pub patches: usize,
    /// Measured above the floor.
    pub above_floor: usize,
    pub violations: usize,
    /// Greatest measured over predicted, above the floor.
    pub worst: f64,
    /// Median and 90th percentile of predicted over measured, above the floor.
    pub median_ratio: f64,
    pub p90_ratio: f64,
    /// Patches of which nothing is known.
    pub unknown: usize,
    /// Median of all predicted, pixels.
    pub median_px: f64,
    /// 10th percentile, median and 90th of estimated over counted reads; 0 where nothing is marched.
    pub fetches_ratio: [f64; 3],
}

impl Row {
    #[must_use]
    pub fn is_violation(&self) -> bool {
        self.measured_px > self.predicted_px + ROUNDING_PX
    }
}

impl Rows {
    #[must_use]
    pub fn violations(&self) -> Vec<Row> {
        self.rows.iter().filter(|row| row.is_violation()).copied().collect()
    }

    #[must_use]
    pub fn summaries(&self) -> Vec<Summary> {
        trials().iter().map(|trial| self.summary(trial)).collect()
    }

    /// Each method by all of its settings.
    #[must_use]
    pub fn by_method(&self) -> Vec<Summary> {
        let mut methods: Vec<Trial> = trials();
        methods.dedup_by_key(|trial| trial.method);
        methods.iter().map(|trial| self.of(trial, |row| row.trial.method == trial.method)).collect()
    }

    fn summary(&self, trial: &Trial) -> Summary {
        self.of(trial, |row| row.trial == *trial)
    }

    fn of(&self, trial: &Trial, is_own: impl Fn(&Row) -> bool) -> Summary {
        let own: Vec<&Row> = self.rows.iter().filter(|row| is_own(row)).collect();
        let above: Vec<&Row> = own.iter().filter(|row| row.measured_px > FLOOR_PX).copied().collect();
        let ratios = sorted(above.iter().map(|row| row.predicted_px / row.measured_px).collect());
        let predicted = sorted(own.iter().map(|row| row.predicted_px).collect());
        let counted = own.iter().filter(|row| row.fetches > 0.0);
        let fetches = sorted(counted.map(|row| row.expected_fetches / row.fetches).collect());
        Summary {
            trial: *trial,
            patches: own.len(),
            above_floor: above.len(),
            violations: own.iter().filter(|row| row.is_violation()).count(),
            worst: above.iter().map(|r| (r.measured_px - ROUNDING_PX) / r.predicted_px).fold(0.0, f64::max),
            median_ratio: at(&ratios, 0.5),
            p90_ratio: at(&ratios, 0.9),
            unknown: predicted.iter().filter(|p| p.is_infinite()).count(),
            median_px: at(&predicted, 0.5),
            fetches_ratio: [0.1, 0.5, 0.9].map(|share| at(&fetches, share)),
        }
    }
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

fn at(sorted: &[f64], share: f64) -> f64 {
    sorted.get((share * sorted.len() as f64) as usize).or(sorted.last()).copied().unwrap_or(0.0)
}

#[must_use]
pub fn csv(summaries: &[Summary]) -> String {
    let mut text = String::from(
        "method,setting,patches,above_floor,violations,worst_measured_over_predicted,median_ratio,p90_ratio,unknown,median_predicted_px,reads_ratio_p10,reads_ratio_median,reads_ratio_p90\n",
    );
    for s in summaries {
        let candidate = Candidate { method: s.trial.method, setting: s.trial.setting };
        let _ = writeln!(
            text,
            "{},{},{},{},{},{:.3},{:.2},{:.2},{},{:.3},{:.2},{:.2},{:.2}",
            s.trial.method.name(),
            candidate.setting(),
            s.patches,
            s.above_floor,
            s.violations,
            s.worst,
            s.median_ratio,
            s.p90_ratio,
            s.unknown,
            s.median_px,
            s.fetches_ratio[0],
            s.fetches_ratio[1],
            s.fetches_ratio[2]
        );
    }
    text
}

/// For people: each method by all of its settings, what is worse than predicted, and triangles.
#[must_use]
pub fn page(methods: &[Summary], worse: &[String], triangles: &str) -> String {
    let mut text = String::from(HEAD);
    for s in methods {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.3} | {:.2} | {:.2} | {:.2} |",
            s.trial.method.name(),
            s.patches,
            s.above_floor,
            s.violations,
            s.worst,
            s.median_ratio,
            s.p90_ratio,
            s.fetches_ratio[1]
        );
    }
    let _ = writeln!(text, "\n## Worse than predicted\n");
    let _ = writeln!(text, "{}", if worse.is_empty() { "None.".to_owned() } else { worse.join("\n") });
    text + TRIANGLES + &rows(triangles)
}

const HEAD: &str = "# What methods are predicted to be off by, and are

`DISPLACE_CORPUS=... cargo bench --profile dev -p displace-tests --bench predicted` makes this page, [`predicted.csv`](predicted.csv)
with every setting, and [`predicted_triangles.csv`](predicted_triangles.csv).

What is bounded is the reprojection error (`server/src/domain/choose.rs`): how far, in pixels, the true surface at the parameter
that a pixel shows is from that pixel. 10 000 random parts of random triangles, half of them flat, some with normals that lean and
some with mitres, on generated maps and maps of the corpus that repeat or are clamped, at any midlevel, seen from 0 to 85 degrees
with and without perspective. Measured is the greatest of 200 rays through the part and 96 more around the worst, by the f64 twins.
Ratios are of predicted over measured where 0.05 pixels and more are measured; reads are estimated over counted, and 0 where nothing
is marched. A displaced method is one by uniform levels: what is made to a tolerance keeps that.

| method | predictions | measured above 0.05 px | worse than predicted | greatest measured / predicted | median ratio | 90 % below | median of reads |
|---|---|---|---|---|---|---|---|
";
const TRIANGLES: &str = "
## Triangles of a tolerance

Of `displace apply --tolerance-world` on a square of two triangles, 1 wide.

";

/// Of CSV, as Markdown has them.
fn rows(csv: &str) -> String {
    let row = |line: &str| format!("| {} |\n", line.replace(',', " | "));
    let mut lines = csv.lines();
    let head = lines.next().unwrap_or_default();
    let rule = format!("|{}\n", "---|".repeat(head.split(',').count()));
    row(head) + &rule + &lines.map(row).collect::<String>()
}
