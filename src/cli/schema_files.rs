//! The files of `schemas/`: how they are generated, and how a stale one is found without generating it, which takes a build of its own.
//! `schemas/SOURCES` has the hash of everything that they were generated from, and of the files themselves.

use crate::output::sha256;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The folder of the generated files, in that of the package.
const SCHEMA_FOLDER: &str = "schemas";

/// The list of hashes in [`SCHEMA_FOLDER`].
const SOURCES_FILE: &str = "SOURCES";

/// Folders whose types have derived schemas.
const SOURCE_FOLDERS: [&str; 4] =
    ["src", "crates/sagnac-base/src", "crates/sagnac-noise/src", "crates/sagnac-explain/src"];

/// How a line begins that gives a type its schema.
const SCHEMA_DERIVES: [&str; 2] =
    ["#[cfg_attr(feature = \"schema\", derive(schemars::JsonSchema", "impl schemars::JsonSchema for "];

/// Writes every schema that types derive, and the hashes; with `check` writes nothing. Gives the names of the files that were not up to date.
///
/// # Errors
/// What the operating system says of a file.
#[cfg(feature = "schema")]
pub fn generate(package: &Path, check: bool) -> io::Result<Vec<&'static str>> {
    let folder = package.join(SCHEMA_FOLDER);
    let mut stale = vec![];
    let mut put = |name: &'static str, text: String| {
        let path = folder.join(name);
        if fs::read_to_string(&path).is_ok_and(|there| there.replace("\r\n", "\n") == text) {
            return Ok(());
        }
        stale.push(name);
        if check { Ok(()) } else { fs::write(path, text) }
    };
    for (name, schema) in derived() {
        put(name, format!("{:#}\n", schema.as_value()))?;
    }
    put(SOURCES_FILE, hashes(package)?)?;
    Ok(stale)
}

/// The schemas that types derive, by the names of their files.
#[cfg(feature = "schema")]
fn derived() -> [(&'static str, schemars::Schema); 8] {
    use crate::mismatch::joint::record::JointExplanation;
    use crate::output::Listed;
    use crate::plan::Plan;
    use crate::record::explanation::Explanation;
    use crate::record::{DataSheet, HistoryRecord, LotRecord, ProofRecord, RunRecord};
    use schemars::schema_for;
    [
        ("result.json", schema_for!(Listed<RunRecord>)),
        ("explain.json", schema_for!(Listed<Explanation>)),
        ("joint.json", schema_for!(Listed<JointExplanation>)),
        ("lot.json", schema_for!(Listed<LotRecord>)),
        ("plan.json", schema_for!(Listed<Plan>)),
        ("proof-result.json", schema_for!(Listed<ProofRecord>)),
        ("datasheet.json", schema_for!(Listed<DataSheet>)),
        ("history.json", schema_for!(HistoryRecord)),
    ]
}

/// A line for each source file with types that derive a schema, for `schemars` itself, and for each generated file: hash and name.
fn hashes(package: &Path) -> io::Result<String> {
    let mut files = vec![];
    for folder in SOURCE_FOLDERS {
        files_below(&package.join(folder), "rs", &mut files)?;
    }
    let mut lines = vec![];
    for file in &files {
        let declarations = declarations(&fs::read_to_string(file)?);
        if !declarations.is_empty() {
            lines.push(line(package, file, &declarations));
        }
    }
    let lock = package.join("Cargo.lock");
    let locked = fs::read_to_string(&lock)?.replace("\r\n", "\n");
    let schemars = locked.split("\n\n").filter(|part| part.contains("name = \"schemars"));
    lines.push(line(package, &lock, &schemars.collect::<Vec<_>>().join("\n")));
    let mut generated = vec![];
    files_below(&package.join(SCHEMA_FOLDER), "json", &mut generated)?;
    for file in &generated {
        lines.push(line(package, file, &fs::read_to_string(file)?.replace("\r\n", "\n")));
    }
    Ok(lines.concat())
}

fn line(package: &Path, file: &Path, text: &str) -> String {
    let name = file.strip_prefix(package).unwrap_or(file).to_string_lossy().replace('\\', "/");
    format!("{}  {name}\n", sha256(text.as_bytes()))
}

/// The parts of a source file that a schema is made from: what derives or implements `JsonSchema`, with its comments and attributes. A file
/// that declares types by a macro counts as a whole. The layout is that of rustfmt: a blank line before an item, its end as
/// far to the left as its beginning.
fn declarations(source: &str) -> String {
    let text = source.replace("\r\n", "\n");
    let names = |line: &str| SCHEMA_DERIVES.iter().any(|d| line.trim_start().starts_with(d));
    if text.contains("macro_rules!") && text.lines().any(names) {
        return text;
    }
    let lines: Vec<&str> = text.lines().collect();
    let mut parts: Vec<&str> = vec![];
    let mut read = 0;
    for (i, line) in lines.iter().enumerate().filter(|(_, line)| names(line)) {
        if i < read {
            continue;
        }
        let begin = lines[read..i].iter().rposition(|l| l.is_empty()).map_or(read, |blank| read + blank + 1);
        let left = &line[..line.len() - line.trim_start().len()];
        let ends = |l: &&str| {
            let item = l.strip_prefix(left).is_some_and(|l| !l.starts_with([' ', '#', '/']));
            item && (l.ends_with('}') || l.ends_with(';'))
        };
        read = lines[i..].iter().position(ends).map_or(lines.len(), |end| i + end + 1);
        parts.extend(&lines[begin..read]);
    }
    parts.join("\n")
}

fn files_below(folder: &Path, extension: &str, files: &mut Vec<PathBuf>) -> io::Result<()> {
    let mut paths = fs::read_dir(folder)?.map(|e| Ok(e?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    for path in paths {
        if path.is_dir() {
            files_below(&path, extension, files)?;
        } else if path.extension().is_some_and(|e| e == extension) {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn schemas_are_up_to_date() {
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let stored = fs::read_to_string(package.join(SCHEMA_FOLDER).join(SOURCES_FILE)).unwrap();
        let now = hashes(package).unwrap();
        let [stored, now] = [&stored, &now].map(|text| text.lines().collect::<BTreeSet<_>>());
        assert!(now.len() > 30, "the search found only {} files", now.len());
        let names = stored.symmetric_difference(&now).filter_map(|line| line.split_whitespace().last());
        let changed: BTreeSet<&str> = names.collect();
        assert!(changed.is_empty(), "run `cargo xtask schemas`: these changed since it ran: {changed:#?}");
    }

    const SOURCE: &str = "use a::B;

/// Result of a test.
#[derive(Debug)]
#[cfg_attr(feature = \"schema\", derive(schemars::JsonSchema))]
pub struct Result {
    /// Value.
    #[serde(default)]
    pub value: f64,

    pub unit: Unit,
}

impl Result {
    fn twice(&self) -> f64 {
        2.0 * self.value
    }
}

/// Unit of a value.
#[cfg_attr(feature = \"schema\", derive(schemars::JsonSchema))]
pub struct Unit(String);

mod tests {}
";

    #[test]
    fn all_of_a_type_with_a_schema_counts_and_nothing_else() {
        let declared = declarations(SOURCE);
        for part in
            ["/// Result of a test.", "#[serde(default)]", "pub unit: Unit,", "pub struct Unit(String);"]
        {
            assert!(declared.contains(part), "{part}: {declared}");
            assert_ne!(declarations(&SOURCE.replacen(part, "other", 1)), declared, "{part}");
        }
        for part in ["use a::B;", "2.0 * self.value", "mod tests {}"] {
            assert_eq!(declarations(&SOURCE.replacen(part, "other", 1)), declared, "{part}");
        }
        assert_eq!(declarations(&SOURCE.replace('\n', "\r\n")), declared);
        assert_eq!(declarations("struct Plain;\n\n// JsonSchema is for others\n"), "");
    }
}
