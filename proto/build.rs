//! Compiles the protos without protoc: protox parses them, tonic-prost-build writes the Rust.

use std::{env, fs, path::PathBuf};

use prost::Message as _;

const PROTOS: [&str; 16] = [
    "displace/v1/common.proto",
    "displace/v1/base.proto",
    "displace/v1/tolerance.proto",
    "displace/v1/geometry.proto",
    "displace/v1/relief.proto",
    "displace/v1/look.proto",
    "displace/v1/method.proto",
    "displace/v1/choice.proto",
    "displace/v1/sequence.proto",
    "displace/v1/request.proto",
    "displace/v1/assets.proto",
    "displace/v1/comparison.proto",
    "displace/v1/stability.proto",
    "displace/v1/chart.proto",
    "displace/v1/displacement.proto",
    "displace/v1/server.proto",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-changed=displace");
    println!("cargo:rerun-if-changed=google");
    let descriptors = protox::compile(PROTOS, ["."])?;
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out.join("displace.v1.bin"), descriptors.encode_to_vec())?;
    tonic_prost_build::configure()
        .bytes(".")
        .extern_path(".google.rpc", "::tonic_types::pb")
        .compile_fds(descriptors)?;
    Ok(())
}
