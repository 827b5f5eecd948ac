//! `displace measure`: how far a mesh is from another, or from the surface a detail describes.

use clap::ArgMatches;
use displace_proto::v1::{Distance, MeasureRequest, Measurement, Report, SheetFacts};
use serde_json::{Value, json};

use super::{
    Session,
    answer::{answer, wanted},
    blocking,
};
use crate::{
    args::MeasureArgs,
    error::{Error, Result},
    jobs::Job,
    options::{self, MaterialGroup},
    output::{Terminal, count},
    report,
    request::{self, Parcel},
};

pub(super) async fn run(
    session: &Session,
    args: &MeasureArgs,
    matches: &ArgMatches,
    terminal: &mut Terminal<'_>,
) -> Result<()> {
    let painted = wanted("error.glb", args.output.as_deref())?;
    let groups = options::groups(&args.detail, matches)?;
    let (message, parcel) = request(session, args, groups).await?;
    let mut report = answer(session, &Job::Measure(message), &parcel, painted, terminal.progress()).await?;
    report.warnings.extend(report::conversion_warnings(&parcel.notes));
    let found = report.measurement.take();
    let found = found.ok_or_else(|| Error::internal("the server's report holds no measurement"))?;
    terminal.report(&as_json(&found, &report), &words(&found, &report))
}

async fn request(
    session: &Session,
    args: &MeasureArgs,
    groups: Vec<MaterialGroup>,
) -> Result<(MeasureRequest, Parcel)> {
    let (mesh, result) = (args.mesh.clone(), args.result.clone());
    let (fresh, linger_secs) = (session.global.fresh, Some(session.connection().await?.linger_secs));
    let (seams, feather_texels) = (request::seams(args.seams).into(), Some(args.feather));
    let base = request::base(args.base).into();
    let (precision, colors) = (Some(args.precision), args.output.is_some());
    blocking(move || {
        let mut parcel = Parcel::default();
        let (mesh, result) = (Some(parcel.mesh(&mesh)?), Some(parcel.mesh(&result)?));
        let details = parcel.details(&groups)?;
        let message = MeasureRequest {
            mesh,
            details,
            seams,
            feather_texels,
            result,
            precision,
            colors,
            fresh,
            linger_secs,
            base,
        };
        Ok((message, parcel))
    })
    .await
}

/// What is not known is absent.
fn as_json(found: &Measurement, report: &Report) -> Value {
    let hausdorff = found.hausdorff.clone().unwrap_or_default();
    let way = |distance: &Option<Distance>| {
        let d = distance.clone().unwrap_or_default();
        json!({ "lo": d.lo, "hi": d.hi, "mean": d.mean, "rms": d.rms, "at": d.at, "nearest": d.nearest })
    };
    let mut value = json!({
        "hausdorff": {
            "lo": hausdorff.lo, "hi": hausdorff.hi,
            "a_to_b": way(&hausdorff.a_to_b), "b_to_a": way(&hausdorff.b_to_a),
        },
        "rms": found.rms,
    });
    if let Some(n) = &found.normal_deg {
        value["normal_deg"] = json!({ "p50": n.p50, "p95": n.p95, "p99": n.p99, "max": n.max });
    }
    value["seam_gap"] = found.seam_gap.into();
    value["volume"] = json!({});
    for (name, volume) in [("a", found.volume_a), ("b", found.volume_b)] {
        if let Some(volume) = volume {
            value["volume"][name] = volume.into();
        }
    }
    if let Some(stretch) = &found.stretch {
        value["stretch"] = json!({ "p99": stretch.p99, "max": stretch.max });
    }
    value["unit"] = "world".into();
    value["diagonal"] = found.diagonal.into();
    value["precision"] = found.precision.into();
    for (name, facts) in [("a", &found.a), ("b", &found.b)] {
        value[name] = facts_json(&facts.unwrap_or_default());
    }
    value["warnings"] = report.warnings.iter().map(|w| json!({ "code": w.code, "message": w.message })).collect();
    value["total_ms"] = report.total_ms.into();
    value["cached"] = report.cached.into();
    value
}

fn facts_json(facts: &SheetFacts) -> Value {
    let mut value = json!({
        "triangles": facts.triangles,
        "area": facts.area,
        "boundary_edges": facts.boundary_edges,
        "nonmanifold_edges": facts.nonmanifold_edges,
        "degenerate_triangles": facts.degenerate_triangles,
        "components": facts.components,
        "euler_characteristic": facts.euler_characteristic,
        "residual": facts.residual,
    });
    if let Some(back) = facts.facing_back {
        value["facing_back"] = back.into();
    }
    if let Some(pairs) = facts.self_intersections {
        value["self_intersections"] = pairs.into();
    }
    value
}

fn words(found: &Measurement, report: &Report) -> String {
    let hausdorff = found.hausdorff.clone().unwrap_or_default();
    let share = |d: f64| if found.diagonal > 0.0 { 100.0 * d / found.diagonal } else { 0.0 };
    let interval = |lo: f64, hi: f64| format!("{lo:.6e} to {hi:.6e} ({:.4} % of the diagonal)", share(hi));
    let mut lines = vec![format!("Hausdorff distance {}, world units", interval(hausdorff.lo, hausdorff.hi))];
    for (name, distance) in [("there", &hausdorff.a_to_b), ("back", &hausdorff.b_to_a)] {
        let d = distance.clone().unwrap_or_default();
        lines.push(format!("  {name:5} {}; mean {:.3e}, RMS {:.3e}", interval(d.lo, d.hi), d.mean, d.rms));
    }
    if let Some(n) = &found.normal_deg {
        lines.push(format!(
            "normals differ by {:.3} degrees in the median, {:.3} at 95 %, {:.3} at 99 %, {:.3} at most",
            n.p50, n.p95, n.p99, n.max
        ));
    }
    if let Some(stretch) = &found.stretch {
        lines.push(format!(
            "the surface stretches its base {:.3} times at 99 %, {:.3} at most",
            stretch.p99, stretch.max
        ));
    }
    lines.push(format!("widest crack {:.3e}", found.seam_gap));
    if let (Some(a), Some(b)) = (found.volume_a, found.volume_b) {
        lines.push(format!("volume {a:.6e} against {b:.6e}"));
    }
    let facts = found.b.unwrap_or_default();
    lines.push(format!(
        "{} triangles; {} boundary edges, {} non-manifold, {} degenerate, {} facing back{}",
        count(facts.triangles),
        count(facts.boundary_edges),
        count(facts.nonmanifold_edges),
        count(facts.degenerate_triangles),
        count(facts.facing_back.unwrap_or_default()),
        facts.self_intersections.map_or_else(String::new, |n| format!(", {} self-intersections", count(n)))
    ));
    lines.extend(report.warnings.iter().map(|w| format!("warning: {}", w.message)));
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_absent() {
        let text = as_json(&Measurement::default(), &Report::default()).to_string();
        assert!(
            !text.contains("null") && !text.contains("normal_deg") && !text.contains("self_intersections"),
            "{text}"
        );
        let known = Measurement { volume_a: Some(1.0), volume_b: Some(2.0), ..Measurement::default() };
        assert_eq!(as_json(&known, &Report::default())["volume"], json!({ "a": 1.0, "b": 2.0 }));
        assert!(words(&known, &Report::default()).contains("against 2"));
    }
}
