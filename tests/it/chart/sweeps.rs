//! Sweeps: every value and method in every file, errors that grow as they must, and a cancel on the way.

use std::time::{Duration, Instant};

use displace_proto::v1::{
    self, assets_client::AssetsClient, displacement_client::DisplacementClient, job_update::Update, layer::Source,
};
use displace_server::config::Config;
use displace_tests::{
    data::sample,
    meshes,
    server::{displace, start, validated},
};

use super::{QUICK, path, run};

const COLUMNS: &str = "sweep,value,method,setting,triangles,ms,error,metric";

#[test]
fn amplitude_drives_every_method_that_moves_nothing_farther_off() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let (mesh, folder) = (home.path().join("plane.glb"), home.path().join("chart"));
    std::fs::write(&mesh, meshes::plane(2).to_glb()).expect("written");
    let height = sample("maps/rock_height.png");
    let detail = ["--height", path(&height), "--scale", "0.1", "--eye", "0,0.5,0.9", "--look-at", "0,0,0"];
    let more = ["--sweep", "amplitude", "-o", path(&folder)];
    let told =
        run(&[&["chart", path(&mesh)], &detail[..], &QUICK, &more].concat(), validated()).expect_success().json();
    let points = told["sweeps"].as_array().expect("points of sweeps");
    let of = |method: &str| -> Vec<[f64; 2]> {
        let of = points.iter().filter(|point| point["method"] == method && point["setting"] != "shell");
        of.map(|point| ["value", "hit_error_px"].map(|name| point[name].as_f64().expect(name))).collect()
    };
    let flat = of("flat");
    assert_eq!(flat.iter().map(|[value, _]| *value).collect::<Vec<_>>(), [0.25, 0.5, 1.0, 2.0, 4.0]);
    assert!(flat.is_sorted_by(|a, b| a[1] < b[1]), "{flat:?}");
    // A flat plane is off by the heights: half of them for half the scale, but for what hides what.
    assert!((1.7..2.3).contains(&(flat[1][1] / flat[0][1])), "{flat:?}");
    assert!(of("exact").iter().zip(&flat).all(|(exact, flat)| exact[1] < 0.5 * flat[1]), "{:?}", of("exact"));
    let rows = std::fs::read_to_string(folder.join("errors.csv")).expect("errors.csv");
    assert!(rows.starts_with(COLUMNS) && rows.lines().count() == 1 + 3 * points.len(), "{rows}");
    let svg = std::fs::read_to_string(folder.join("errors-amplitude.svg")).expect("errors-amplitude.svg");
    roxmltree::Document::parse(&svg).expect("well-formed XML");
    let page = std::fs::read_to_string(folder.join("index.html")).expect("index.html");
    assert!(page.contains("Where methods break") && page.contains("hit error by amplitude"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_cancel_within_a_sweep_ends_the_chart() {
    let url = start(Config { device: "reference".into(), ..Config::default() });
    let mut assets = AssetsClient::connect(url.clone()).await.unwrap();
    let mesh = crate::service::put(&mut assets, &meshes::plane(1).to_glb()).await;
    let mut client = DisplacementClient::connect(url.clone()).await.unwrap();
    let mut updates = client.chart(swept(mesh)).await.unwrap().into_inner();
    loop {
        let update = updates.message().await.unwrap().expect("the sweeps begin before the chart is done").update;
        assert!(!matches!(update, Some(Update::Result(_))));
        if matches!(update, Some(Update::Progress(progress)) if progress.pass == "angle") {
            break;
        }
    }
    drop(updates);
    let (left_at, url) = (Instant::now(), url.as_str());
    let status = || displace(&["status", "--server", url, "--json"]).json();
    while tokio::task::block_in_place(status)["running_jobs"] != 0 {
        assert!(left_at.elapsed() < Duration::from_secs(8), "sooner than jobs are given up for lost");
    }
    let jobs = tokio::task::block_in_place(status)["jobs"].clone();
    assert_eq!((&jobs[0]["kind"], &jobs[0]["cancelled"]), (&"chart".into(), &1.into()), "{jobs}");
}

/// All sweeps of waves, which only triangles and bump show.
fn swept(mesh: v1::Digest) -> v1::ChartRequest {
    let source = Some(Source::Expression(v1::Expression { source: "0.05*sin(30*u)*cos(20*v)".into() }));
    let layer = v1::Layer { source, ..v1::Layer::default() };
    let surface = v1::DisplaceRequest {
        mesh: Some(v1::MeshSource { asset: Some(mesh), resources: Vec::new() }),
        details: vec![v1::MaterialDetail { layers: vec![layer], ..v1::MaterialDetail::default() }],
        linger_secs: Some(0),
        ..v1::DisplaceRequest::default()
    };
    let view = v1::View { width: 64, height: 64, ..v1::View::default() };
    let render = v1::RenderRequest { surface: Some(surface), views: vec![view], ..v1::RenderRequest::default() };
    let sweeps = [v1::ChartSweep::Angle, v1::ChartSweep::Distance, v1::ChartSweep::Amplitude].map(i32::from).into();
    v1::ChartRequest { render: Some(render), repeats: Some(1), truth_samples: Some(4), sweeps, stability: false }
}
