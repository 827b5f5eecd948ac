//! Rules that the compiler does not check: which module may know which, what a file begins with, how long
//! it may be, and that every link of a document leads somewhere.

use std::{
    fs,
    path::{Path, PathBuf},
};

use displace_tests::data::repository;

/// Files may be longer than this only when they are one table.
const MAX_LINES: usize = 450;
const TABLES: [&str; 0] = [];

/// (folder or file below `server/src`, what it may not name, why).
const FORBIDDEN: &[(&str, &[&str], &str)] = &[
    (
        "domain",
        &[
            "tonic",
            "prost",
            "displace_proto",
            "ash",
            "tokio",
            "crate::vulkan",
            "crate::render",
            "crate::jobs",
            "crate::grpc",
            "crate::store",
        ],
        "the domain decides and knows no transport, no device and no runtime",
    ),
    (
        "vulkan",
        &[
            "tonic",
            "prost",
            "displace_proto",
            "crate::domain",
            "crate::render",
            "crate::jobs",
            "crate::grpc",
            "crate::store",
        ],
        "the device layer knows shaders and streams, not meshes or requests",
    ),
    (
        "oracle",
        &[
            "tonic",
            "prost",
            "displace_proto",
            "ash",
            "tokio",
            "crate::vulkan",
            "crate::render",
            "crate::jobs",
            "crate::grpc",
            "crate::store",
        ],
        "the oracle judges and shares no code with what it judges",
    ),
    (
        "render",
        &["tonic", "prost", "displace_proto", "crate::jobs", "crate::grpc", "crate::store"],
        "executors run plans and do not know who asked",
    ),
    (
        "store",
        &["tonic", "displace_proto", "crate::vulkan", "crate::render", "crate::jobs", "crate::grpc"],
        "the store keeps bytes",
    ),
    (
        "jobs",
        &["displace_proto", "ash", "crate::grpc"],
        "jobs are asked by any transport, and reach the device through an executor",
    ),
    ("grpc", &["ash", "crate::vulkan"], "handlers parse, call and convert"),
];

#[test]
fn modules_know_only_what_lies_below_them() {
    let server = repository().join("server/src");
    let mut broken = Vec::new();
    for (module, words, why) in FORBIDDEN {
        for file in rust_files(&server).into_iter().filter(|file| is_of_module(file, &server, module)) {
            broken.extend(uses_of(&file, words).into_iter().map(|place| format!("{place}: {why}")));
        }
    }
    broken.extend(rust_files(&repository().join("glsl")).iter().flat_map(|file| {
        uses_of(file, &["ash", "tonic", "displace_server"])
            .into_iter()
            .map(|place| format!("{place}: shaders are data; no API is known here"))
    }));
    assert_none(&broken);
}

#[test]
fn every_rust_file_begins_by_telling_its_place() {
    let silent = all_rust_files().into_iter().filter(|file| !text(file).starts_with("//!"));
    assert_none(
        &silent.map(|file| format!("{}: the first line is not a //! comment", show(&file))).collect::<Vec<_>>(),
    );
}

#[test]
fn every_shader_and_proto_begins_with_a_comment() {
    let mut files = files_with(&repository().join("glsl/shaders"), &["comp", "glsl"]);
    files.extend(files_with(&repository().join("proto/displace"), &["proto"]));
    assert!(!files.is_empty());
    let silent = files.into_iter().filter(|file| !text(file).lines().take(8).any(|line| line.starts_with("//")));
    assert_none(
        &silent
            .map(|file| format!("{}: no comment in its first lines says what it does", show(&file)))
            .collect::<Vec<_>>(),
    );
}

#[test]
fn files_are_one_thing_each() {
    let mut files = all_rust_files();
    files.extend(files_with(repository(), &["comp", "glsl", "proto", "py", "mjs"]));
    let long = files.into_iter().filter_map(|file| {
        let lines = text(&file).lines().count();
        let excused = TABLES.iter().any(|table| file.ends_with(table));
        (lines > MAX_LINES && !excused).then(|| format!("{}: {lines} lines; is it two things?", show(&file)))
    });
    assert_none(&long.collect::<Vec<_>>());
}

#[test]
fn modules_are_files_of_their_own_name() {
    let named_mod = all_rust_files().into_iter().filter(|file| file.ends_with("mod.rs"));
    assert_none(&named_mod.map(|file| format!("{}: write foo.rs beside foo/", show(&file))).collect::<Vec<_>>());
}

#[test]
fn nothing_is_left_for_later() {
    let marks = [concat!("todo", "!("), concat!("unimplemented", "!("), concat!("FIX", "ME"), concat!("TO", "DO")];
    let mut files = all_rust_files();
    files.extend(files_with(repository(), &["comp", "glsl", "proto", "py", "mjs"]));
    let left = files.iter().flat_map(|file| lines_with(file, |line| marks.iter().any(|mark| line.contains(mark))));
    assert_none(&left.collect::<Vec<_>>());
}

#[test]
fn the_service_does_not_panic_without_a_reason() {
    // `expect` gives the reason why it cannot happen; `unwrap` gives none.
    let mut broken = Vec::new();
    for package in ["server/src", "client/src", "glsl/src"] {
        for file in rust_files(&repository().join(package)).into_iter().filter(|file| !file.ends_with("tests.rs")) {
            let code = without_tests(&text(&file));
            for (number, line) in code.lines().enumerate().filter(|(_, line)| code_of(line).contains(".unwrap()")) {
                broken.push(format!("{}:{}: {}", show(&file), number + 1, line.trim()));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn only_the_device_layer_is_unsafe() {
    let allowed = repository().join("server/src/vulkan");
    let broken = all_rust_files()
        .into_iter()
        .filter(|file| !file.with_extension("").starts_with(&allowed) && !file.ends_with("tidy.rs"));
    let places =
        broken.flat_map(|file| lines_with(&file, |line| has_word(line, "unsafe") || has_word(line, "unsafe_code")));
    assert_none(&places.collect::<Vec<_>>());
}

#[test]
fn links_of_documents_lead_somewhere() {
    let mut broken = Vec::new();
    for file in files_with(repository(), &["md"]) {
        for target in links(&text(&file)) {
            let path = target.split('#').next().unwrap_or_default();
            let external = target.contains("://") || target.starts_with("mailto:") || path.is_empty();
            if !external && !file.parent().is_some_and(|folder| folder.join(path).exists()) {
                broken.push(format!("{}: {target} does not exist", show(&file)));
            }
        }
    }
    assert_none(&broken);
}

fn assert_none(broken: &[String]) {
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

fn text(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

fn show(file: &Path) -> String {
    file.strip_prefix(repository()).unwrap_or(file).display().to_string()
}

fn is_of_module(file: &Path, server: &Path, module: &str) -> bool {
    file.starts_with(server.join(module)) || file == server.join(module).with_extension("rs")
}

fn all_rust_files() -> Vec<PathBuf> {
    rust_files(repository())
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    files_with(folder, &["rs"])
}

/// Files below `folder` with one of the extensions; build outputs, dot-folders and fetched packages left out.
fn files_with(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.expect("a folder can be listed").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') || ["target", "node_modules", "out"].contains(&name.as_str()) {
            continue;
        }
        if path.is_dir() {
            files.extend(files_with(&path, extensions));
        } else if path.extension().is_some_and(|extension| extensions.iter().any(|wanted| extension == *wanted)) {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// `path:line: word` for each use of a forbidden crate or module outside comments.
fn uses_of(file: &Path, words: &[&str]) -> Vec<String> {
    let mut places = Vec::new();
    for (number, line) in text(file).lines().enumerate() {
        for word in words.iter().filter(|word| names(code_of(line), word)) {
            places.push(format!("{}:{}: {word}", show(file), number + 1));
        }
    }
    places
}

/// Does the code name the crate or module `word` as a path: `word::` or `use word`?
fn names(code: &str, word: &str) -> bool {
    word_starts(code, word).any(|at| {
        let rest = &code[at + word.len()..];
        let used = code[..at].trim_end().ends_with("use") && rest.starts_with([';', ' ', ':']);
        let grouped = word.strip_prefix("crate::").is_some_and(|_| rest.starts_with([';', ',', '}', ' ']));
        rest.starts_with("::") || used || grouped
    }) || word.strip_prefix("crate::").is_some_and(|module| code.contains("use crate::{") && names(code, module))
}

fn has_word(line: &str, word: &str) -> bool {
    word_starts(code_of(line), word).next().is_some()
}

/// Where `word` stands in `code` as a word of its own.
fn word_starts<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word).map(|(at, _)| at).filter(move |&at| {
        let before = code[..at].chars().next_back();
        let after = code[at + word.len()..].chars().next();
        !before.is_some_and(|c| part_of_word(c) || c == ':') && !after.is_some_and(part_of_word)
    })
}

/// The line without its comment.
fn code_of(line: &str) -> &str {
    line.split_once("//").map_or(line, |(code, _)| code)
}

/// The file up to its unit tests.
fn without_tests(text: &str) -> String {
    text.split("#[cfg(test)]").next().unwrap_or_default().to_owned()
}

fn lines_with(file: &Path, wanted: impl Fn(&str) -> bool) -> Vec<String> {
    let text = text(file);
    let lines = text.lines().enumerate().filter(|(_, line)| wanted(line));
    lines.map(|(number, line)| format!("{}:{}: {}", show(file), number + 1, line.trim())).collect()
}

/// Targets of `[text](target)` and `src="target"` outside code blocks.
fn links(markdown: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut in_code = false;
    for line in markdown.lines() {
        in_code ^= line.trim_start().starts_with("```");
        if !in_code {
            found.extend(
                line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned()),
            );
            found.extend(
                line.split("src=\"")
                    .skip(1)
                    .filter_map(|rest| rest.split_once('"'))
                    .map(|(target, _)| target.to_owned()),
            );
        }
    }
    found
}

#[test]
fn the_rules_see_what_they_forbid() {
    assert!(names("use tonic::Status;", "tonic") && names("    tonic::Status", "tonic") && names("use ash;", "ash"));
    assert!(
        names("use crate::vulkan::Device;", "crate::vulkan")
            && names("use crate::{vulkan::Device, x};", "crate::vulkan")
    );
    assert!(
        !names("let hash = 1;", "ash")
            && !names("tonic_types::X", "tonic")
            && !names("domain::vulkan::X", "crate::vulkan")
    );
    assert_eq!(links("see [a](b.md#c) and <img src=\"d.png\">"), ["b.md#c", "d.png"]);
}
