//! `Displacement.Compare` over the service, on images that the service has rendered: what the figures say, and what is
//! refused.

use displace_proto::v1::{self, displacement_client::DisplacementClient, job_update::Update};
use displace_tests::{
    cli::Run,
    meshes::{self, TestMesh},
    server::{displace, reference, start},
};
use serde_json::Value;
use tonic::Code;
use tonic_types::StatusExt as _;

const WIDTH: u32 = 48;
const HEIGHT: u32 = 40;

/// A folder of images.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("temporary folders are UTF-8").to_owned()
    }

    fn file(&self, name: &str, content: &[u8]) -> String {
        std::fs::write(self.path(name), content).expect("the folder can be written");
        self.path(name)
    }

    /// The mesh, its vertices moved along their normals, from 10 units along +Z; the image is 4 units high at z = 0, so
    /// that a unit there has 10 pixels.
    fn render(&self, name: &str, mesh: &TestMesh, expression: &str, flags: &[&str]) -> String {
        let (mesh, output) = (self.file("mesh.glb", &mesh.to_glb()), self.path(name));
        let yfov = (2.0 * 0.2f64.atan()).to_degrees().to_string();
        let mut args = vec!["render", &mesh, "--eye", "0,0,10", "--look-at", "0,0,0", "--fov", &yfov, "-o", &output];
        args.extend(["--size", "48x40", "--expr", expression, "--uniform", "2"]);
        args.extend(flags);
        remote(&args).expect_success();
        output
    }

    fn sphere(&self, name: &str, expression: &str, flags: &[&str]) -> String {
        self.render(name, &meshes::icosphere(3), expression, flags)
    }
}

fn remote(args: &[&str]) -> Run {
    displace(&[args, &["--server", reference()]].concat())
}

fn compare(a: &str, b: &str) -> Value {
    remote(&["compare", a, b, "--json"]).expect_success().json()
}

fn refused(a: &str, b: &str, field: &str, words: &str) {
    let run = remote(&["compare", a, b, "--json"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    let error = &run.json()["error"];
    assert_eq!(error["field"], field, "{run:?}");
    assert!(error["message"].as_str().unwrap().contains(words), "'{words}' is not in {}", error["message"]);
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn a_picture_does_not_differ_from_itself() {
    let folder = Folder::new();
    let image = folder.sphere("a.png", "0", &[]);
    let same = serde_json::json!({"flip_mean": 0.0, "flip_p99": 0.0, "rmse_linear": 0.0, "ssim": 1.0});
    assert_eq!(compare(&image, &image), same);
}

#[test]
fn pictures_that_differ_say_so_and_the_difference_is_an_image_of_their_size() {
    let folder = Folder::new();
    let (a, b) = (folder.sphere("a.png", "0", &[]), folder.sphere("b.png", "0.3*x", &[]));
    let difference = folder.path("d.png");
    let found = remote(&["compare", &a, &b, "-o", &difference, "--json"]).expect_success().json();
    assert_eq!(keys(&found), ["flip_mean", "flip_p99", "rmse_linear", "ssim"]);
    let figure = |name: &str| found[name].as_f64().unwrap();
    assert!(figure("flip_mean") > 0.0 && figure("flip_p99") > figure("flip_mean") && figure("flip_p99") <= 1.0);
    assert!(figure("rmse_linear") > 0.0 && figure("ssim") < 1.0, "{found}");
    let image = image::open(&difference).unwrap().into_rgb8();
    assert_eq!((image.width(), image.height()), (WIDTH, HEIGHT));
    assert_eq!(image.get_pixel(0, 0).0, [0, 0, 4], "the background is the same");
    assert!(image.pixels().any(|pixel| pixel.0[0] > 60));
    let words = remote(&["compare", &a, &b]).expect_success().stdout;
    assert!(words.starts_with("FLIP 0.") && words.contains("RMSE") && words.contains("SSIM"), "{words}");
}

#[test]
fn layers_of_an_exr_tell_how_far_outlines_moved() {
    let folder = Folder::new();
    let a = folder.sphere("a.exr", "0", &["--aov", "depth"]);
    assert_eq!(compare(&a, &a)["silhouette_xor_px"], 0);
    // A circle's radius of 10 pixels becomes 10 + 3 cos(angle): the area between the two is 120 square pixels.
    let found = compare(&a, &folder.sphere("b.exr", "0.3*x", &["--aov", "triangle"]));
    assert_eq!(keys(&found), ["flip_mean", "flip_p99", "rmse_linear", "ssim", "silhouette_xor_px"]);
    let outline = found["silhouette_xor_px"].as_u64().unwrap();
    assert!((100..140).contains(&outline), "{found}");
}

#[test]
fn layers_of_an_exr_tell_how_far_places_moved() {
    let folder = Folder::new();
    let layers = ["--aov", "depth,position"];
    let plane = |name: &str, height: &str| folder.render(name, &facing(), height, &layers);
    let (a, b) = (plane("a.exr", "0"), plane("b.exr", "0.5"));
    let same = compare(&a, &a);
    assert_eq!((&same["silhouette_xor_px"], &same["hit_error_px"]), (&0.into(), &0.0.into()), "{same}");
    // Half a unit along the axis is 5 pixels, and more along slanted rays: up to 1.0476 times in the corners.
    let found = compare(&a, &b);
    let places = found["hit_error_px"].as_f64().unwrap();
    assert!((5.15..5.25).contains(&places) && found["silhouette_xor_px"] == 0, "{found}");
    // From the nearer of the two a pixel is smaller.
    let back = compare(&b, &a)["hit_error_px"].as_f64().unwrap();
    assert!((back / places - 10.0 / 9.5).abs() < 1e-4, "{back} {places}");
}

#[test]
fn an_exr_and_a_png_of_one_view_are_the_same_to_the_eye() {
    let folder = Folder::new();
    let (a, b) = (folder.sphere("a.exr", "0", &["--aov", "depth"]), folder.sphere("b.png", "0", &[]));
    let found = compare(&a, &b);
    assert_eq!(keys(&found), ["flip_mean", "flip_p99", "rmse_linear", "ssim"]);
    assert_eq!(found["flip_mean"], 0.0, "both are compared in 8 bits");
    // The highlight is brighter than 1, which the PNG cuts.
    let rmse = found["rmse_linear"].as_f64().unwrap();
    assert!((0.01..0.05).contains(&rmse), "{found}");
}

#[test]
fn what_cannot_be_compared_is_refused_by_name() {
    let folder = Folder::new();
    let good = folder.sphere("good.png", "0", &[]);
    let bytes = std::fs::read(&good).unwrap();
    let cut = folder.file("cut.png", &bytes[..bytes.len() / 2]);
    let (empty, text) = (folder.file("empty.png", &[]), folder.file("text.png", b"no image"));
    let small = folder.file("small.png", &png(8, 8));
    refused(&good, &small, "b", "8 x 8 pixels and a has 48 x 40");
    refused(&empty, &good, "a", "empty");
    refused(&good, &text, "b", "neither PNG nor OpenEXR");
    refused(&cut, &good, "a", "cannot be decoded");
    refused("none.png", &good, "none.png", "no such file");
    let run = remote(&["compare", &good, &good, "-o", &folder.path("d.jpg"), "--json"]);
    assert_eq!((run.code, run.json()["error"]["field"].as_str()), (Some(2), Some("--output")));
    // Too small for SSIM, which is then absent.
    assert_eq!(keys(&compare(&small, &small)), ["flip_mean", "flip_p99", "rmse_linear"]);
}

#[test]
fn an_image_above_the_limits_of_the_server_is_refused() {
    let folder = Folder::new();
    let (wide, good) = (folder.file("wide.png", &png(33, 1)), folder.file("good.png", &png(16, 16)));
    let server = start(displace_server::config::Config {
        device: "reference".into(),
        max_image_pixels: 32,
        ..displace_server::config::Config::default()
    });
    let run = displace(&["compare", &good, &wide, "--server", &server, "--json"]);
    let error = &run.json()["error"];
    assert_eq!((run.code, &error["kind"]), (Some(2), &"too_large".into()), "{run:?}");
    let message = error["message"].as_str().unwrap();
    assert!(message.starts_with("b: ") && message.contains("33 x 1") && message.contains("1 to 32"), "{run:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_names_both_images_and_says_how_it_went() {
    let mut client = DisplacementClient::connect(reference()).await.unwrap();
    let digest = super::service::digest_of(&png(16, 12));
    let request = v1::CompareRequest { a: Some(digest.clone()), ..v1::CompareRequest::default() };
    let status = client.compare(request).await.unwrap_err();
    assert_eq!(status.code(), Code::InvalidArgument);
    assert_eq!(status.get_details_bad_request().unwrap().field_violations[0].field, "b");

    let mut assets = v1::assets_client::AssetsClient::connect(reference()).await.unwrap();
    let (a, b) = (super::service::put(&mut assets, &png(16, 12)).await, Some(digest));
    let request = v1::CompareRequest { a: Some(a), b, fresh: true, linger_secs: Some(0) };
    let mut updates = client.compare(request).await.unwrap().into_inner();
    let mut result = None;
    while let Some(update) = updates.message().await.unwrap() {
        if let Some(Update::Result(done)) = update.update {
            result = Some(done);
        }
    }
    let result = result.expect("a result");
    let report = result.report.unwrap();
    assert_eq!(report.comparison.unwrap().ssim, Some(1.0));
    let names: Vec<_> = report.passes.iter().map(|pass| pass.name.as_str()).collect();
    assert_eq!(names, ["read_images", "compare", "encode"]);
    assert_eq!(
        (result.outputs[0].name.as_str(), result.outputs[0].media_type.as_str()),
        ("difference.png", "image/png")
    );
}

/// A square of 20 units across +Z, which fills the view.
fn facing() -> TestMesh {
    let mut mesh = meshes::plane(1);
    mesh.positions.iter_mut().for_each(|[x, y, z]| [*x, *y, *z] = [20.0 * *x, -20.0 * *z, 0.0]);
    mesh.normals.fill([0.0, 0.0, 1.0]);
    mesh
}

/// A grey image.
fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::GrayImage::from_fn(width, height, |x, y| image::Luma([(x * 37 + y * 11) as u8]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
