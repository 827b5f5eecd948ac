//! `displace chart`: time against error of every method, or where methods fail, in a folder with a page that shows it.

mod stability;

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use clap::ArgMatches;
use displace_proto::v1::{ChartMetric, ChartPoint, ChartReport, ChartRequest, Method, Output, RenderRequest, Report};
use serde_json::{Value, json};

use super::{
    Session, blocking,
    surface::{Surface, save},
};
use crate::{
    args::{ChartArgs, CompressArg, GeometryArgs, MethodArg},
    error::{Error, Kind, Result},
    jobs::{self, Job},
    options,
    output::{Target, Terminal, count, duration_ms},
    report::{self, Written},
    request,
};

pub(super) async fn run(
    session: &Session,
    args: &ChartArgs,
    matches: &ArgMatches,
    terminal: &mut Terminal<'_>,
) -> Result<()> {
    let (message, parcel) = request(session, args, matches).await?;
    let folder = folder(&args.output)?;
    let (connection, progress) = (session.connection().await?, terminal.progress());
    let result = jobs::run(connection, &Job::Chart(Box::new(message)), &parcel.blobs, progress).await?;
    let written = save(connection, &placed(result.outputs, &folder)?, progress).await?;
    let mut report = result.report.unwrap_or_default();
    report.warnings.extend(report::conversion_warnings(&parcel.notes));
    let chart = report.chart.as_ref().ok_or_else(|| Error::internal("the server's report holds no chart"))?;
    if let Some(found) = &chart.stability {
        let json = stability::as_json(&report, chart, found, &written);
        return terminal.report(&json, &stability::words(&report, found, &folder));
    }
    terminal.report(&as_json(&report, chart, &written), &words(&report, chart, &folder))
}

async fn request(session: &Session, args: &ChartArgs, matches: &ArgMatches) -> Result<(ChartRequest, request::Parcel)> {
    let surface = Surface {
        mesh: args.mesh.clone(),
        groups: options::groups(&args.detail, matches)?,
        geometry: GeometryArgs::default(),
        look: args.look.clone(),
        method: MethodArg::Flat,
        compress: CompressArg::None,
        lods: 0,
    };
    let (mut surface, mut parcel) = surface.request(session).await?;
    // The chart's own to choose.
    (surface.geometry, surface.method) = (None, Method::Unspecified.into());
    let environment = args.light.env.clone();
    let (parcel, environment) = blocking(move || {
        let environment = environment.map(|path| parcel.environment(&path)).transpose()?;
        Ok((parcel, environment))
    })
    .await?;
    let render = RenderRequest {
        surface: Some(surface),
        views: vec![request::view(&args.camera)],
        lighting: Some(request::lighting(&args.look, &args.light, environment)),
        ..RenderRequest::default()
    };
    let (repeats, truth_samples) = (Some(args.repeats), Some(args.truth_samples));
    Ok((ChartRequest { render: Some(render), repeats, truth_samples, stability: args.stability }, parcel))
}

fn folder(path: &Path) -> Result<PathBuf> {
    fs::create_dir_all(path).map_err(|e| {
        let message = format!("{} cannot be made a folder: {e}; name another", path.display());
        Error::new(Kind::Usage, message).with_field("--output")
    })?;
    Ok(path.to_owned())
}

/// Each under its own name, which leads nowhere else.
fn placed(outputs: Vec<Output>, folder: &Path) -> Result<Vec<(Output, Target)>> {
    let place = |output: Output| {
        let name = Path::new(&output.name);
        if name.file_name() != Some(name.as_os_str()) {
            return Err(Error::internal(format!(
                "the server named an output '{}', which is no file name",
                output.name
            )));
        }
        let target = Target::new(&folder.join(name))?;
        Ok((output, target))
    };
    outputs.into_iter().map(place).collect()
}

fn as_json(report: &Report, chart: &ChartReport, written: &[Written]) -> Value {
    let outputs: Vec<Value> = written
        .iter()
        .map(|o| json!({ "path": o.path, "digest": o.digest, "bytes": o.bytes, "media_type": o.media_type }))
        .collect();
    let warnings: Vec<Value> =
        report.warnings.iter().map(|w| json!({ "code": w.code, "message": w.message })).collect();
    json!({
        "points": chart.points.iter().map(point_json).collect::<Vec<_>>(),
        "width": chart.width,
        "height": chart.height,
        "truth_samples": chart.truth_samples,
        "truth_ms": chart.truth_ms,
        "triangles_in": report.triangles_in,
        "device": report.device,
        "driver": chart.driver,
        "warnings": warnings,
        "total_ms": report.total_ms,
        "outputs": outputs,
        "cached": report.cached,
    })
}

/// What is not known is absent.
fn point_json(point: &ChartPoint) -> Value {
    let error = point.error.unwrap_or_default();
    let mut value = json!({
        "name": point.name,
        "method": point.method,
        "setting": point.setting,
        "triangles": point.triangles,
        "vertices": point.vertices,
        "scene_bytes": point.scene_bytes,
        "ms": point.ms,
        "geometry_ms": point.geometry_ms,
        "image_ms": point.image_ms,
        "setup_ms": point.setup_ms,
        "runs": point.runs,
        "flip_mean": error.flip_mean,
        "flip_p99": error.flip_p99,
        "rmse_linear": error.rmse_linear,
        "fronts": point.fronts().map(metric_name).collect::<Vec<_>>(),
    });
    let mut put = |name: &str, known: Option<Value>| {
        if let Some(known) = known {
            value[name] = known;
        }
    };
    put("ms_spread", point.ms_spread.map(Value::from));
    put("silhouette_xor_px", error.silhouette_xor_px.map(Value::from));
    put("hit_error_px", error.hit_error_px.map(Value::from));
    put("predicted_px", point.predicted_px.map(Value::from));
    put("chosen", point.chosen.then(|| Value::from(true)));
    let counters = point.counters.as_ref();
    put(
        "counters",
        counters.map(|c| json!({ "rays": c.rays, "fetches": c.fetches, "steps": c.steps, "cap_hits": c.cap_hits })),
    );
    value
}

fn metric_name(metric: ChartMetric) -> &'static str {
    match metric {
        ChartMetric::Unspecified => "",
        ChartMetric::Flip => "flip",
        ChartMetric::HitPx => "hit_px",
        ChartMetric::SilhouettePx => "silhouette_px",
    }
}

/// Where the table has it.
fn is_told(point: &ChartPoint) -> bool {
    point.chosen || point.fronts().any(|metric| metric == ChartMetric::Flip || metric == ChartMetric::HitPx)
}

/// The settings that no other beats and the automatic choice, fastest first.
fn words(report: &Report, chart: &ChartReport, folder: &Path) -> String {
    let mut front: Vec<&ChartPoint> = chart.points.iter().filter(|point| is_told(point)).collect();
    front.sort_by(|a, b| a.ms.total_cmp(&b.ms));
    let mut text = format!(
        "{} settings at {} x {} pixels on {}; none is as fast and nearer than these:\n\n{:<22} {:>12} {:>10} {:>9} {:>9} {:>12}  front\n",
        chart.points.len(),
        chart.width,
        chart.height,
        report.device,
        "setting",
        "triangles",
        "time",
        "FLIP",
        "hit px",
        "outline px"
    );
    for point in front {
        text += &row(point);
    }
    text.push('\n');
    for warning in &report.warnings {
        let _ = writeln!(text, "warning: {}", warning.message);
    }
    let cached = if report.cached { ", stored before" } else { "" };
    let _ =
        writeln!(text, "{} in all{cached}. Open {}", duration_ms(report.total_ms), folder.join("index.html").display());
    text
}

fn row(point: &ChartPoint) -> String {
    let error = point.error.unwrap_or_default();
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    let fronts: Vec<&str> = point
        .fronts()
        .filter_map(|metric| match metric {
            ChartMetric::Flip => Some("FLIP"),
            ChartMetric::HitPx => Some("hit"),
            _ => None,
        })
        .chain(point.chosen.then_some("auto"))
        .collect();
    format!(
        "{:<22} {:>12} {:>10} {:>9.5} {:>9} {:>12}  {}\n",
        format!("{} {}", point.method, point.setting).trim_end(),
        count(point.triangles),
        duration_ms(point.ms),
        error.flip_mean,
        or_dash(error.hit_error_px.map(|px| format!("{px:.3}"))),
        or_dash(error.silhouette_xor_px.map(count)),
        fronts.join(", "),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_output_lies_outside_of_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let output = |name: &str| Output { name: name.into(), ..Output::default() };
        for bad in ["../x.png", "/etc/x", "a/b.png", "", ".."] {
            assert!(placed(vec![output(bad)], folder.path()).is_err(), "{bad}");
        }
        assert!(placed(vec![output("relief-16.png")], folder.path()).is_ok());
    }

    #[test]
    fn the_table_has_the_fronts_alone_fastest_first() {
        let point = |method: &str, ms: f64, fronts: &[ChartMetric]| ChartPoint {
            method: method.into(),
            ms,
            fronts: fronts.iter().map(|metric| i32::from(*metric)).collect(),
            ..ChartPoint::default()
        };
        let points = vec![
            point("exact", 9.0, &[ChartMetric::HitPx]),
            point("steep", 5.0, &[ChartMetric::SilhouettePx]),
            point("flat", 1.0, &[ChartMetric::Flip]),
        ];
        let text = words(&Report::default(), &ChartReport { points, ..ChartReport::default() }, Path::new("d"));
        let rows: Vec<&str> = text.lines().skip(3).take_while(|line| !line.is_empty()).collect();
        assert!(rows.len() == 2 && rows[0].starts_with("flat") && rows[1].starts_with("exact"), "{text}");
        assert!(!text.contains("steep") && text.contains("d/index.html"), "{text}");
    }
}
