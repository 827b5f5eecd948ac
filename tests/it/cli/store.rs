//! Assets, and what the server says of itself.

use displace_glsl::methods::METHODS;
use displace_tests::server::displace;

use super::{Folder, keys, remote, report};

#[test]
fn an_asset_comes_back_as_it_went() {
    let folder = Folder::new();
    let large: Vec<u8> = (0..3_000_000u32).map(|i| i.wrapping_mul(2_654_435_761).to_le_bytes()[3]).collect();
    let files = [folder.file("empty", ""), folder.file("small", "abc"), folder.file("large", &large)];
    let put = report(&[&["assets".to_owned(), "put".to_owned()][..], &files].concat());
    for (asset, file) in put["assets"].as_array().unwrap().iter().zip(&files) {
        let name = asset["name"].as_str().unwrap();
        assert!(remote(&["assets", "ls"]).expect_success().stdout.contains(name));
        let copy = folder.path("copy");
        remote(&["assets", "get", name, "-o", &copy]).expect_success();
        assert!(std::fs::read(&copy).unwrap() == std::fs::read(file).unwrap(), "{file}");
    }
    let small = put["assets"][1]["name"].as_str().unwrap();
    assert_eq!(remote(&["assets", "get", small, "-o", "-"]).expect_success().stdout, "abc");
    assert_eq!(report(&["assets", "rm", small])["assets"][0]["deleted"], true);
    assert_eq!(report(&["assets", "rm", small])["assets"][0]["deleted"], false);
}

#[test]
fn an_asset_that_is_not_there_is_code_2_and_no_file() {
    let folder = Folder::new();
    let name = format!("{}/5", "0".repeat(64));
    let run = remote(&["assets", "get", &name, "-o", &folder.path("copy"), "--json"]);
    assert_eq!((run.code, run.json()["error"]["kind"].as_str()), (Some(2), Some("not_found")));
    assert!(folder.names().is_empty());
}

#[test]
fn the_server_describes_itself() {
    let methods = report(&["methods"]);
    let names: Vec<_> = methods["methods"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
    let known: Vec<_> = METHODS.iter().map(|row| row.name).collect();
    assert_eq!(names, known);
    assert_eq!(names[..6], ["flat", "displacement", "vector", "bump", "normal", "steep"]);
    assert_eq!(keys(&methods["methods"][0]), ["name", "summary", "represents", "cost"]);
    let status = report(&["status"]);
    assert_eq!(status["build_id"], displace_server::BUILD_ID);
    assert_eq!(status["devices"][0]["name"], "reference");
    for service in ["live", "ready"] {
        assert_eq!(report(&["health", service])["status"], "serving");
    }
}

#[test]
fn quiet_says_nothing_and_words_name_the_file() {
    let folder = Folder::new();
    let mesh = folder.file("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let output = folder.path("out.glb");
    let args = ["apply", &mesh, "--expr", "x", "--uniform", "1", "-o", &output];
    let words = remote(&args).expect_success();
    assert!(words.stdout.contains("out.glb") && words.stdout.contains("4 triangles"), "{}", words.stdout);
    assert_eq!(words.stderr, "");
    let quiet = remote(&[&args[..], &["-q"]].concat()).expect_success();
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
    assert_eq!(displace(&["status", "-q", "-v"]).code, Some(2));
}
