//! The licences of what the program is built from, in one file that can travel with it.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const FILE: &str = "THIRD-PARTY.md";
const HEAD: &str = "# Third-party notices

The program contains the packages below. Written by `cargo xtask notices`.
A build with the feature `pdf` also contains the fonts in `crates/sagnac-pdf/fonts`, under the SIL Open Font License 1.1 (`OFL.txt` there).

| package | version | licence | source |
|---|---|---|---|
";

/// In place of the text of Apache 2.0, which packages carry in a dozen layouts.
const APACHE: &str = "Apache License, Version 2.0: the text is in LICENSE-APACHE";

/// Writes the notices, or with `check` compares them with the file.
pub fn run(root: &Path, check: bool) -> ExitCode {
    let notices = match notices(root) {
        Ok(notices) => notices,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let path = root.join(FILE);
    if check {
        if std::fs::read_to_string(&path).is_ok_and(|there| there == notices) {
            return ExitCode::SUCCESS;
        }
        eprintln!("{FILE} is not up to date; run cargo xtask notices");
        return ExitCode::FAILURE;
    }
    match std::fs::write(&path, notices) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("failed to write {}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}

/// What cargo says of the packages, with those of the feature `pdf`.
pub fn metadata(root: &Path) -> Result<Value, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let done = Command::new(cargo)
        .current_dir(root)
        .args(["metadata", "--format-version", "1", "--locked", "--features", "sagnac/pdf"])
        .output()
        .map_err(|e| format!("failed to start cargo: {e}"))?;
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).into_owned());
    }
    serde_json::from_slice(&done.stdout).map_err(|e| e.to_string())
}

fn notices(root: &Path) -> Result<String, String> {
    let metadata = metadata(root)?;
    let linked = linked(&metadata);
    let mut packages: Vec<&Value> = list(&metadata["packages"])
        .filter(|p| linked.contains(text(&p["id"])) && !p["source"].is_null())
        .collect();
    packages.sort_by_key(|p| (text(&p["name"]), text(&p["version"])));
    let mut out = HEAD.to_owned();
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in packages {
        let (name, version) = (text(&package["name"]), text(&package["version"]));
        let (licence, source) = (text(&package["license"]), text(&package["repository"]));
        let _ = writeln!(out, "| {name} | {version} | {licence} | {source} |");
        for licence in licence_texts(Path::new(text(&package["manifest_path"]))) {
            let licence =
                if licence.contains("Version 2.0, January 2004") { APACHE.to_owned() } else { licence };
            texts.entry(licence).or_default().push(format!("{name} {version}"));
        }
    }
    out.push_str("\n## Texts\n");
    let mut texts: Vec<(Vec<String>, String)> = texts.into_iter().map(|(text, of)| (of, text)).collect();
    texts.sort();
    for (of, text) in texts {
        let _ = write!(out, "\n### {}\n\n```text\n{}\n```\n", of.join(", "), text.replace("```", "'''"));
    }
    Ok(out)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

/// Ids of the packages that are linked into the program: not those of tests and of building.
pub fn linked(metadata: &Value) -> BTreeSet<String> {
    let nodes: BTreeMap<&str, &Value> =
        list(&metadata["resolve"]["nodes"]).map(|n| (text(&n["id"]), n)).collect();
    let program = list(&metadata["packages"]).find(|p| text(&p["name"]) == "sagnac").map(|p| text(&p["id"]));
    let mut open: Vec<&str> = program.into_iter().collect();
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop() {
        if !seen.insert(id.to_owned()) {
            continue;
        }
        for dependency in nodes.get(id).into_iter().flat_map(|n| list(&n["deps"])) {
            if list(&dependency["dep_kinds"]).any(|k| k["kind"].is_null()) {
                open.push(text(&dependency["pkg"]));
            }
        }
    }
    seen
}

/// The texts of the files of a package that are named as licences or notices are.
fn licence_texts(manifest: &Path) -> Vec<String> {
    let Some(folder) = manifest.parent().and_then(|f| std::fs::read_dir(f).ok()) else { return vec![] };
    let named = |name: &str| {
        ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"]
            .iter()
            .any(|n| name.to_uppercase().starts_with(n))
    };
    let mut files: Vec<_> = folder
        .flatten()
        .filter(|f| f.path().is_file() && named(&f.file_name().to_string_lossy()))
        .map(|f| f.path())
        .collect();
    files.sort();
    // Of a package under MIT or Apache 2.0 the program uses the former; the latter is in LICENSE-APACHE anyway.
    let apache = |f: &PathBuf| f.to_string_lossy().to_uppercase().contains("APACHE");
    if !files.iter().all(apache) {
        files.retain(|f| !apache(f));
    }
    let lines =
        |text: String| text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n").trim().to_owned();
    files.iter().filter_map(|f| std::fs::read_to_string(f).ok()).map(lines).collect()
}
