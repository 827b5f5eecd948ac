//! Compiles every shader, reads its interface back from the SPIR-V, and writes both as Rust.

#[path = "build/compile.rs"]
mod compile;
#[path = "build/emit.rs"]
mod emit;
#[path = "build/reflect.rs"]
mod reflect;

use std::{env, fs, path::PathBuf, process::ExitCode};

fn main() -> ExitCode {
    println!("cargo:rerun-if-changed=shaders");
    println!("cargo:rerun-if-changed=build");
    match build() {
        Ok(()) => ExitCode::SUCCESS,
        Err(errors) => {
            // `cargo::error` lines are shown even when the build runs quietly.
            for line in errors.lines() {
                println!("cargo::error={line}");
            }
            ExitCode::FAILURE
        }
    }
}

fn build() -> Result<(), String> {
    let shaders = compile::all(&PathBuf::from("shaders"))?;
    let mut interfaces = Vec::new();
    for shader in shaders {
        let interface = reflect::interface(&shader.name, &shader.words)?;
        interfaces.push((shader, interface));
    }
    let source = emit::rust(&interfaces)?;
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?).join("shaders.rs");
    fs::write(&out, source).map_err(|e| format!("{}: {e}", out.display()))
}
