//! GLSL to SPIR-V with glslang. Every message names its file and line.

use std::{
    fs,
    path::{Path, PathBuf},
};

use glslang::{
    Compiler, CompilerOptions, ShaderInput, ShaderMessage, ShaderSource, ShaderStage, SourceLanguage, SpirvVersion,
    Target, VulkanVersion,
    include::{IncludeHandler, IncludeResult, IncludeType},
};

/// JIT time on software drivers grows faster than the code of a shader. 20 KiB is the rule; the interpreter of
/// expressions with derivatives needs more, and so do light and surroundings over many normals.
const MAX_CODE_BYTES: usize = 34 << 10;

pub(crate) struct Compiled {
    /// File stem, which is also the name of the pass.
    pub(crate) name: String,
    pub(crate) words: Vec<u32>,
}

/// Compiles all `*.comp` below `folder`, in the order of their names.
pub(crate) fn all(folder: &Path) -> Result<Vec<Compiled>, String> {
    let mut paths = Vec::new();
    for folder in [folder.to_path_buf(), folder.join("methods")] {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        let files = entries.flatten().map(|entry| entry.path());
        paths.extend(files.filter(|p| p.extension().is_some_and(|e| e == "comp")));
    }
    paths.sort();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let lots: Vec<Vec<PathBuf>> =
        (0..threads).map(|k| paths.iter().skip(k).step_by(threads).cloned().collect()).collect();
    let results: Vec<Result<Compiled, String>> = std::thread::scope(|scope| {
        let workers: Vec<_> =
            lots.iter().map(|lot| scope.spawn(|| lot.iter().map(|p| one(folder, p)).collect::<Vec<_>>())).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    let (compiled, errors): (Vec<_>, Vec<_>) = results.into_iter().partition(Result::is_ok);
    if !errors.is_empty() {
        return Err(errors.into_iter().filter_map(Result::err).collect::<Vec<_>>().join("\n"));
    }
    let mut compiled: Vec<Compiled> = compiled.into_iter().flatten().collect();
    if compiled.len() != paths.len() {
        return Err("a compiler thread died".into());
    }
    compiled.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(compiled)
}

fn one(root: &Path, path: &Path) -> Result<Compiled, String> {
    let shown = format!("glsl/{}", path.display());
    let name = path.file_stem().and_then(|s| s.to_str()).ok_or(format!("{shown}: the name is not UTF-8"))?;
    let text = fs::read_to_string(path).map_err(|e| format!("{shown}: {e}"))?;
    let (version, rest) = text.split_once('\n').ok_or(format!("{shown}:1: no #version line"))?;
    // Every shader may include; `#line` keeps the numbers of the messages those of the file.
    let text = format!("{version}\n#extension GL_GOOGLE_include_directive : require\n#line 2\n{rest}");
    let source = ShaderSource::from(text);
    let options = CompilerOptions {
        source_language: SourceLanguage::GLSL,
        target: Target::Vulkan { version: VulkanVersion::Vulkan1_3, spirv_version: SpirvVersion::SPIRV1_6 },
        version_profile: None,
        messages: ShaderMessage::DEFAULT,
    };
    let mut includes = Includes { root };
    let compiler = Compiler::acquire().ok_or("glslang did not start")?;
    let explain = |error: glslang::error::GlslangError| messages(&shown, &error.to_string());
    let input =
        ShaderInput::new(&source, ShaderStage::Compute, &options, None, Some(&mut includes)).map_err(explain)?;
    let words = compiler.create_shader(input).map_err(explain)?.compile().map_err(explain)?;
    let bytes = code_bytes(&words);
    if bytes > MAX_CODE_BYTES {
        return Err(format!("{shown}: {bytes} bytes of code in SPIR-V; at most {MAX_CODE_BYTES}: split the pass"));
    }
    Ok(Compiled { name: name.to_owned(), words })
}

/// Size of the functions: names, types and decorations are nothing a driver compiles.
fn code_bytes(words: &[u32]) -> usize {
    const FUNCTION: u32 = 54;
    const FUNCTION_END: u32 = 56;
    let mut rest = &words[words.len().min(5)..];
    let (mut inside, mut kept) = (false, 0);
    while let Some(first) = rest.first() {
        let (length, op) = (((first >> 16) as usize).clamp(1, rest.len()), first & 0xFFFF);
        inside |= op == FUNCTION;
        kept += if inside { length } else { 0 };
        inside &= op != FUNCTION_END;
        rest = &rest[length..];
    }
    kept * 4
}

/// glslang calls the main file `0`; everything it says becomes `path:line: message`.
fn messages(shown: &str, log: &str) -> String {
    let lines: Vec<String> = log
        .lines()
        .filter_map(|line| line.split_once("ERROR: ").map(|(_, rest)| rest))
        .filter(|line| !line.contains("compilation errors"))
        .map(|line| match line.strip_prefix("0:") {
            Some(rest) => format!("{shown}:{rest}"),
            None => format!("glsl/shaders/{line}"),
        })
        .collect();
    if lines.is_empty() { format!("{shown}: {log}") } else { lines.join("\n") }
}

/// All include paths start at `shaders/`.
struct Includes<'a> {
    root: &'a Path,
}

impl IncludeHandler for Includes<'_> {
    fn include(&mut self, _: IncludeType, header: &str, _: &str, _: usize) -> Option<IncludeResult> {
        let data = fs::read_to_string(self.root.join(header)).ok()?;
        Some(IncludeResult { name: header.to_owned(), data })
    }
}
