//! Writes the `SHADERS` table and the struct offsets as Rust source.

use std::{collections::BTreeMap, fmt::Write as _};

use crate::{
    compile::Compiled,
    reflect::{Interface, Struct},
};

pub(crate) fn rust(shaders: &[(Compiled, Interface)]) -> Result<String, String> {
    let mut out = String::new();
    table(&mut out, shaders).map_err(|e| e.to_string())?;
    offsets(&mut out, &merged(shaders)?).map_err(|e| e.to_string())?;
    Ok(out)
}

fn table(out: &mut String, shaders: &[(Compiled, Interface)]) -> std::fmt::Result {
    writeln!(out, "/// Every compute shader, by the name of its pass.\n#[derive(Debug)]\npub struct Shaders {{")?;
    for (shader, _) in shaders {
        writeln!(out, "    pub {}: ComputeShader,", shader.name)?;
    }
    writeln!(out, "}}\n\npub static SHADERS: Shaders = Shaders {{")?;
    for (shader, interface) in shaders {
        entry(out, shader, interface)?;
    }
    writeln!(out, "}};\n\n/// All of [`SHADERS`], in the order of their names.")?;
    writeln!(out, "pub static ALL_SHADERS: &[&ComputeShader] = &[")?;
    for (shader, _) in shaders {
        writeln!(out, "    &SHADERS.{},", shader.name)?;
    }
    writeln!(out, "];")
}

fn entry(out: &mut String, shader: &Compiled, interface: &Interface) -> std::fmt::Result {
    writeln!(out, "    {name}: ComputeShader {{\n        name: \"{name}\",", name = shader.name)?;
    writeln!(out, "        local_size: {:?},", interface.local_size)?;
    writeln!(out, "        push_constant_bytes: {},", interface.push_constant_bytes)?;
    writeln!(out, "        bindings: &[")?;
    for b in &interface.bindings {
        writeln!(
            out,
            "            Binding {{ name: {:?}, binding: {}, count: {}, element_bytes: {}, writable: {} }},",
            b.name, b.binding, b.count, b.element_bytes, b.writable
        )?;
    }
    writeln!(out, "        ],\n        words: &{:?},\n    }},", shader.words)
}

/// One layout per struct name over all shaders, or an error that names both.
fn merged(shaders: &[(Compiled, Interface)]) -> Result<BTreeMap<&str, &Struct>, String> {
    let mut all: BTreeMap<&str, (&str, &Struct)> = BTreeMap::new();
    for (shader, interface) in shaders {
        for (name, layout) in &interface.structs {
            if let Some((other, known)) = all.get(name.as_str())
                && *known != layout
            {
                return Err(format!("struct {name} is laid out in two ways: in {other} and in {}", shader.name));
            }
            all.insert(name, (&shader.name, layout));
        }
    }
    Ok(all.into_iter().map(|(name, (_, layout))| (name, layout)).collect())
}

fn offsets(out: &mut String, structs: &BTreeMap<&str, &Struct>) -> std::fmt::Result {
    writeln!(out, "\n/// Where GLSL has each member of each shared struct, in bytes.")?;
    writeln!(out, "#[allow(non_snake_case, non_upper_case_globals, dead_code, reason = \"names are GLSL's\")]")?;
    writeln!(out, "pub(crate) mod offsets {{")?;
    for (name, layout) in structs {
        writeln!(out, "    pub(crate) mod {name} {{")?;
        writeln!(out, "        pub(crate) const MEMBERS: usize = {};", layout.members.len())?;
        writeln!(out, "        pub(crate) const SIZE: usize = {};", layout.size)?;
        for (member, offset) in &layout.members {
            writeln!(out, "        pub(crate) const {member}: usize = {offset};")?;
        }
        writeln!(out, "    }}")?;
    }
    writeln!(out, "}}")
}
