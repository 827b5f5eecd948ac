//! The real command, with the service inside it.

use std::{
    io::Read,
    process::Stdio,
    time::{Duration, Instant},
};

use displace_server::config::Config;
use displace_tests::{
    cli::{Displace, signal},
    data::sample,
    server,
};

#[test]
fn the_command_brings_its_own_service() {
    let displace = Displace::default();
    let mesh = sample("models/torus.gltf");
    let args = ["apply", mesh.to_str().unwrap(), "--expr", "0.1*u", "--uniform", "1", "-o", "out.glb", "--json"];
    let run = displace.run([&args[..], &["--device", "reference"]].concat()).expect_success();
    assert_eq!(run.json()["outputs"][0]["media_type"], "model/gltf-binary");
    assert!(displace.folder().join("out.glb").is_file());
    assert!(displace.folder().join("data").is_dir(), "the store lies under XDG_DATA_HOME");
    let again = displace.run([&args[..], &["--device", "reference"]].concat()).expect_success();
    assert_eq!(again.json()["cached"], true, "the store outlives the command");
}

#[test]
fn commands_without_device_work_need_no_driver() {
    let displace = Displace::default();
    let mesh = sample("models/torus.gltf");
    for args in [&["describe", mesh.to_str().unwrap()][..], &["assets", "ls"], &["methods"]] {
        let output = displace.command().env("VK_DRIVER_FILES", "/nonexistent").args(args).output().unwrap();
        assert!(output.status.success(), "{args:?}: {output:?}");
    }
}

#[test]
fn an_unknown_device_is_refused_by_name() {
    let displace = Displace::default();
    let run = displace.run(["status", "--device", "no such device", "--json"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    assert_eq!(run.json()["error"]["field"], "--device");
    assert!(run.stderr.contains("no such device"), "{}", run.stderr);
}

#[test]
fn a_reader_that_leaves_early_is_no_fault() {
    let mut child = Displace::default()
        .command()
        .args(["completions", "zsh"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
}

/// Interrupts a long job after a while; its exit code and standard output.
fn interrupted(displace: &Displace, place: [&str; 2]) -> (Option<i32>, String) {
    let mesh = sample("models/torus.gltf");
    let mut child = displace
        .command()
        .args(["apply", mesh.to_str().unwrap(), "--expr", "0.01*sin(900*u)*cos(800*v)", "--uniform", "6"])
        .args(["-o", "out.glb", "--json"])
        .args(place)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    let sent = Instant::now();
    signal(&child, "INT");
    let code = child.wait().unwrap().code();
    assert!(sent.elapsed() < Duration::from_secs(5), "{:?}", sent.elapsed());
    let mut stdout = String::new();
    child.stdout.take().unwrap().read_to_string(&mut stdout).unwrap();
    (code, stdout)
}

#[test]
fn an_interrupt_is_code_130_and_leaves_no_output() {
    let displace = Displace::default();
    let (code, stdout) = interrupted(&displace, ["--device", "reference"]);
    assert_eq!(code, Some(130), "{stdout}");
    assert!(stdout.contains("\"interrupted\""), "{stdout}");
    let left: Vec<_> = std::fs::read_dir(displace.folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .filter(|name| name.to_string_lossy().contains("glb"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn an_interrupt_ends_the_job_at_a_server_elsewhere() {
    let url = server::start(Config { device: "reference".into(), ..Config::default() });
    let status = || server::displace(&["status", "--server", &url, "--json"]).json();
    let (code, stdout) = interrupted(&Displace::default(), ["--server", &url]);
    assert_eq!(code, Some(130), "{stdout}");
    let left_at = Instant::now();
    while status()["running_jobs"] != 0 {
        // Before the job would be given up for lost, after 10 s.
        assert!(left_at.elapsed() < Duration::from_secs(8));
    }
    assert_eq!(status()["jobs"][0]["cancelled"], 1);
}

#[test]
fn the_demo_shows_everything() {
    let displace = Displace::default();
    let run = displace.run(["demo", "--out", "shown", "--json"]).expect_success();
    let files: Vec<String> =
        run.json()["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap().to_owned()).collect();
    let count = |ending: &str| files.iter().filter(|file| file.ends_with(ending)).count();
    assert!(count(".glb") >= 3 && count(".png") >= 5, "{files:?}");
    let page = std::fs::read_to_string(displace.folder().join("shown/index.html")).unwrap();
    assert!(files.iter().any(|file| file.ends_with("/shown/chart/index.html")), "{files:?}");
    for link in ["chart/index.html", "chart/chart.svg"] {
        assert!(
            page.contains(&format!("\"{link}\"")) && displace.folder().join("shown").join(link).is_file(),
            "{link}"
        );
    }
    for file in files.iter().filter(|file| !file.ends_with(".html")) {
        assert!(std::path::Path::new(file).is_file(), "{file}");
        let name = file.rsplit('/').next().unwrap();
        assert!(page.contains(&format!("\"{name}\"")), "{name} is not on the page");
    }
    assert!(!page.contains("http"), "the page needs nothing from elsewhere");
}
