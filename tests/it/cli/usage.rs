//! What is refused before anything is sent, and what needs no server.

use displace_tests::{data::sample, server::displace};

fn refused(flags: &str, field: &str, parts: &[&str]) {
    let mesh = sample("models/torus.gltf");
    let mut args: Vec<String> = flags.split_whitespace().map(str::to_owned).collect();
    if let Some(place) = args.iter().position(|word| word == "MESH") {
        args[place] = mesh.to_string_lossy().into_owned();
    }
    args.push("--json".into());
    let run = displace(&args);
    assert_eq!(run.code, Some(2), "{flags}: {run:?}");
    let error = &run.json()["error"];
    assert_eq!(error["field"], field, "{flags}: {run:?}");
    assert!(matches!(error["kind"].as_str(), Some("usage" | "invalid_input")), "{run:?}");
    for part in parts {
        assert!(run.stderr.contains(part), "{flags}: '{part}' is not in {}", run.stderr);
    }
}

#[test]
fn a_refusal_names_flag_value_range_and_fix() {
    refused("apply MESH -o o.glb --uniform 13", "--uniform", &["13", "0..=12"]);
    refused("apply MESH -o o.glb --uniform x", "--uniform", &["'x'"]);
    refused("apply MESH -o o.glb --uniform 1 --feather -1", "--feather", &["-1", "0 and above"]);
    refused("apply MESH -o o.glb --uniform 1 --max-triangles 0", "--max-triangles", &["0"]);
    refused("apply MESH -o o.glb --expr u --scale nan --uniform 1", "--scale", &["nan", "finite"]);
    refused("apply MESH -o o.glb --vector v.exr --swizzle rrb --uniform 1", "--swizzle", &["rrb", "rgb"]);
    refused("apply MESH -o o.glb --uniform 1 --compress zip", "--compress", &["zip", "quantize", "meshopt"]);
    refused("render MESH -o o.png --size 0x10", "--size", &["0x10", "1280x720"]);
    refused("render MESH -o o.png --fov 200 --orbit 1,2", "--fov", &["200", "1 to 170"]);
    refused("render MESH -o o.png --fov 20", "--eye", &["--orbit"]);
    refused("render MESH -o o.png --orbit 1,91", "--orbit", &["91", "-90 to 90"]);
    refused("render MESH -o o.png --light 0,0,0", "--light", &["0,0,0"]);
    refused("render MESH -o o.png --ambient 2", "--ambient", &["2", "0 to 1"]);
    refused("render MESH -o o.png --light 1,2,3@171", "--light", &["171"]);
    refused("render MESH -o o.png --light point:0,0,0,-1", "--light", &["-1"]);
    refused("render MESH -o o.png --reflect a --reflect-size 8", "--reflect-size", &["8", "16"]);
    refused("render MESH -o o.png --preimage 1", "--preimage", &["1"]);
    refused("render MESH -o o.png --env-layout ball", "--env-layout", &["equirect", "cube", "sphere"]);
    refused("render MESH -o o.jpg", "--output", &[".png", ".exr"]);
    refused("render MESH -o o.png --aov depth,depth", "--aov", &["once"]);
}

#[test]
fn what_says_how_a_tolerance_is_kept_is_for_methods_that_keep_one() {
    refused("render MESH -o o.png --method flat --quality high", "--quality", &["there is none"]);
    refused("render MESH -o o.png --method bump --error-at texels", "--error-at", &["there is none"]);
}

#[test]
fn a_tolerance_out_of_range_is_refused_with_what_is_allowed() {
    refused("apply MESH -o o.glb --tolerance 1e-7", "--tolerance", &["1e-7", "1e-6 to 1"]);
    refused("apply MESH -o o.glb --tolerance -1", "--tolerance", &["-1", "1e-6 to 1"]);
    refused("apply MESH -o o.glb --tolerance-world 0", "--tolerance-world", &["above 0"]);
    let view = "--view 0,1,3;0,0,0;40;64x48";
    refused(&format!("apply MESH -o o.glb {view} --tolerance-px 0"), "--tolerance-px", &["0.01 to 1000"]);
    refused("apply MESH -o o.glb --tolerance-px 1 --view 0,1,3;0,0,0;40", "--view", &["EYE;LOOK;FOV;WxH"]);
    refused("apply MESH -o o.glb --tolerance 1e-3 --quality best", "--quality", &["normal", "high"]);
    refused("apply MESH -o o.glb --tolerance 1e-3 --error-at vertices", "--error-at", &["surface", "texels"]);
}

#[test]
fn one_thing_alone_says_how_fine_the_result_is() {
    let conflict = |flags: &str, field: &str, other: &str| {
        refused(&format!("apply MESH -o o {flags}"), field, &["cannot be used with", other]);
    };
    conflict("--uniform 1 --tolerance 1e-3", "--uniform", "--tolerance <SHARE>");
    conflict("--tolerance-world 1 --tolerance 1e-3", "--tolerance-world", "--tolerance <SHARE>");
    conflict("--tolerance-px 1 --view 0,1,3;0,0,0;40;64x48 --uniform 1", "--tolerance-px", "--uniform");
    conflict("--uniform 1 --quality high", "--uniform", "--quality");
    conflict("--uniform 1 --error-at texels", "--uniform", "--error-at");
    conflict("--uniform 1 --lods 2", "--uniform", "--lods");
    refused("render MESH -o o.png --exact --tolerance 1e-3", "--exact", &["cannot be used with", "--tolerance"]);
    refused("apply MESH -o o.glb --tolerance-px 1", "--view", &["--view"]);
    refused("apply MESH -o o.glb --view 0,1,3;0,0,0;40;64x48", "--tolerance-px", &["--tolerance-px"]);
}

#[test]
fn contradictions_in_detail_are_refused() {
    refused("apply MESH -o o.glb --uniform 1 --direction d.png", "--magnitude", &["--direction MAP needs --magnitude"]);
    refused("apply MESH -o o.glb --uniform 1 --scale 2", "--scale", &["no map to belong to"]);
    refused("apply MESH -o o.glb --uniform 1 --expr u --channel g", "--channel", &["belongs after --height"]);
    refused("apply MESH -o o.glb --uniform 1 --material A", "--material", &["without a map"]);
}

#[test]
fn files_that_are_not_there_are_named() {
    refused("apply none.glb -o o.glb --uniform 1", "none.glb", &["no such file"]);
    refused("apply MESH -o o.glb --uniform 1 --height none.png", "--height", &["none.png", "no such file"]);
    refused("apply MESH -o none/o.glb --uniform 1", "--output", &["no folder"]);
    refused("apply MESH -o / --uniform 1", "--output", &["is a folder"]);
    refused("describe MESH --server https://h:1", "--server", &["TLS"]);
    refused("describe MESH --server http://127.0.0.1:1 --device x", "--device", &["leave out"]);
    refused("assets get xyz -o o", "NAME", &["xyz", "HASH/SIZE"]);
}

#[test]
fn flags_of_later_versions_do_not_exist() {
    for flag in ["--steps", "--self-shadow", "--silhouettes", "--orbit-frames", "--supersample"] {
        let run = displace(&["apply", "m.glb", "-o", "o.glb", flag, "1"]);
        assert_eq!(run.code, Some(2), "{flag}");
        assert!(run.stderr.contains("unexpected argument"), "{flag}: {}", run.stderr);
    }
    for command in ["measure", "compare", "chart", "bake", "unwrap", "batch"] {
        assert_eq!(displace(&[command]).code, Some(2), "{command}");
    }
}

#[test]
fn help_and_version_go_to_standard_output() {
    for args in [&["--help"][..], &["apply", "--help"], &["render", "-h"], &["assets", "put", "--help"], &["--version"]]
    {
        let run = displace(args);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{args:?}");
        assert!(!run.stdout.is_empty(), "{args:?}");
    }
    let version = displace(&["--version"]).stdout;
    assert_eq!(version.trim(), format!("displace {}", displace_server::BUILD_ID));
    let apply = displace(&["apply", "--help"]).stdout;
    for part in ["Examples:", "--tolerance <SHARE>", "--tolerance-world", "--tolerance-px", "EYE;LOOK;FOV;WxH", "1e-3"]
    {
        assert!(apply.contains(part), "{part} is not in {apply}");
    }
}

#[test]
fn completions_know_the_flags() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let run = displace(&["completions", shell]).expect_success();
        assert!(run.stdout.contains("uniform") && run.stdout.contains("tolerance-px"), "{shell}");
    }
}

#[test]
fn a_server_that_is_not_there_is_code_3() {
    let run = displace(&["status", "--json", "--server", "http://127.0.0.1:1"]);
    assert_eq!((run.code, run.json()["error"]["kind"].as_str()), (Some(3), Some("unavailable")));
    assert!(run.stderr.contains("127.0.0.1:1"), "{}", run.stderr);
}
