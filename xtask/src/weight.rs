//! Prints how much there is of what, and how often each thing is written down.
//!
//! A line of code is one that is neither blank nor a comment. Nothing here fails: the table tells where weight is.

use crate::modules::{self, Module, Package};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, ExitCode};
use std::{fs, io};

/// A file of this many lines of code or more is no splinter.
const SPLINTER_LINES: usize = 60;
/// Commits from here on count for the files that a change touches, where no date is given.
pub const COMMITS_SINCE: &str = "2026-11-24";
/// The package of the program, and those that its `run` leads to.
const PACKAGES: [&str; 11] = [
    "src",
    "crates/sagnac-base/src",
    "crates/sagnac-core/src",
    "crates/sagnac-explain/src",
    "crates/sagnac-noise/src",
    "crates/sagnac-ingest/src",
    "crates/sagnac-fft/src",
    "crates/sagnac-pdf/src",
    "crates/sagnac-bench/src",
    "crates/sagnac-serve/src",
    "crates/sagnac-table-derive/src",
];

/// A tracked file with its lines of code, apart by what they are for.
struct Source {
    path: String,
    text: String,
    product: usize,
    tests: usize,
}

/// Prints the table.
pub fn print(root: &Path, since: &str) -> ExitCode {
    match table(root, since) {
        Ok(rows) => {
            let width = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or_default();
            for (name, value) in rows {
                println!("{name:width$}  {value}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("weight: {error}");
            ExitCode::FAILURE
        }
    }
}

fn table(root: &Path, since: &str) -> io::Result<Vec<(String, String)>> {
    let sources = sources(root)?;
    let product: Vec<&Source> = sources.iter().filter(|s| is_product(&s.path)).collect();
    let rust: Vec<&&Source> = product.iter().filter(|s| s.path.ends_with(".rs")).collect();
    let lines = |wanted: &dyn Fn(&str) -> bool| -> usize {
        sources.iter().filter(|s| wanted(&s.path)).map(|s| s.product + s.tests).sum()
    };
    let count = |of: &dyn Fn(&str) -> usize| -> usize { rust.iter().map(|s| of(&s.text)).sum() };
    let mut rows = vec![];
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));

    for (name, commits) in touched(root, since)? {
        row(&format!("files touched {name} (median of commits since {since})"), commits);
    }
    let (row_types, limit_types) = (types(&rust, &is_row), types(&rust, &is_limit));
    row("types for a row of a measurand", format!("{}: {}", row_types.len(), row_types.join(", ")));
    row("types for a limit", format!("{}: {}", limit_types.len(), limit_types.join(", ")));
    row("product, lines of code", product.iter().map(|s| s.product).sum::<usize>().to_string());
    row("  reached by `sagnac run`, Rust", reached(root)?.to_string());
    row("tests and inline tests, lines of code", {
        let inline: usize = product.iter().map(|s| s.tests).sum();
        (inline + lines(&|p| is_test(p))).to_string()
    });
    row("studies, lines of code", lines(&|p| p.starts_with("studies/")).to_string());
    row("product files in Rust", rust.len().to_string());
    row(
        &format!("  under {SPLINTER_LINES} lines of code"),
        rust.iter().filter(|s| s.product < SPLINTER_LINES).count().to_string(),
    );
    row("constants named by one word", count(&one_word_constants).to_string());
    row("doc comments of the form \"What ... is ...\"", count(&dialect_comments).to_string());
    for (room, (files, lines)) in rooms(&product) {
        row(&format!("room {room}"), format!("{lines} lines in {files} files"));
    }
    Ok(rows)
}

fn is_test(path: &str) -> bool {
    let stem = path.rsplit('/').next().unwrap_or(path).trim_end_matches(".rs");
    let test = stem.ends_with("tests") || ["test_evidence", "truths"].contains(&stem);
    (test && path.ends_with(".rs")) || path.starts_with("tests/it/") || path.contains("/tests/")
}

fn is_product(path: &str) -> bool {
    let wanted = ["src/", "crates/", "templates/"].iter().any(|p| path.starts_with(p));
    // Sentences in two languages are text, not code.
    wanted
        && !is_test(path)
        && !path.starts_with("templates/locale/")
        && !path.contains("/examples/")
        && !path.contains("/studies/")
}

fn sources(root: &Path) -> io::Result<Vec<Source>> {
    let listed =
        git(root, &["ls-files", "*.rs", "*.py", "*.html", "*.md", "*.typ", "*.css", "*.js", "templates"])?;
    let mut sources = vec![];
    let paths: BTreeSet<&str> = listed.lines().collect();
    for path in paths {
        let document = path.ends_with(".md") && !path.starts_with("templates/");
        if document || path.starts_with("docs/") || !root.join(path).is_file() {
            continue;
        }
        let Ok(text) = fs::read_to_string(root.join(path)) else { continue };
        let (own, inline) = if path.ends_with(".rs") {
            let parts = text.split_once("#[cfg(test)]\nmod tests {");
            parts.map_or((text.as_str(), ""), |(own, inline)| (own, inline))
        } else {
            (text.as_str(), "")
        };
        let (product, tests) = (code_lines(own, path), code_lines(inline, path));
        sources.push(Source { path: path.to_owned(), product, tests, text: own.to_owned() });
    }
    Ok(sources)
}

/// Lines that are neither blank nor a comment.
fn code_lines(text: &str, path: &str) -> usize {
    let comment = match path.rsplit('.').next() {
        Some("rs") => Some("//"),
        Some("py") => Some("#"),
        _ => None,
    };
    let is_comment = |line: &str| comment.is_some_and(|mark| line.starts_with(mark));
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !is_comment(line)).count()
}

/// Named structs of a text with the names of their fields.
fn structs(text: &str) -> Vec<(String, BTreeSet<String>)> {
    let mut found = vec![];
    for part in text.split("struct ").skip(1) {
        let Some((head, body)) = part.split_once('{') else { continue };
        let name: String = head.chars().take_while(|c| c.is_alphanumeric()).collect();
        if name.is_empty() || head.contains(';') || head.contains('(') {
            continue;
        }
        let body = body.split("\n}").next().unwrap_or_default();
        let field = |line: &str| {
            let line = line.trim().trim_start_matches("pub(crate) ").trim_start_matches("pub(super) ");
            let (name, _) = line.trim_start_matches("pub ").split_once(": ")?;
            name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_').then(|| name.to_owned())
        };
        found.push((name, body.lines().filter_map(field).collect()));
    }
    found
}

fn types(sources: &[&&Source], wanted: &dyn Fn(&str, &BTreeSet<String>) -> bool) -> Vec<String> {
    let mut names = vec![];
    for source in sources {
        let of_file = structs(&source.text).into_iter().filter(|(name, fields)| wanted(name, fields));
        names.extend(of_file.map(|(name, _)| format!("{name} ({})", source.path)));
    }
    names
}

/// A row of results names its quantity and its unit and has a value or a limit.
fn is_row(name: &str, fields: &BTreeSet<String>) -> bool {
    let has = |any: &[&str]| any.iter().any(|f| fields.contains(*f));
    let named = ["Measurand", "Quantity", "Row"].iter().any(|word| name.contains(word));
    named
        && has(&["id", "measurand", "name", "title"])
        && has(&["unit"])
        && has(&["value", "values", "limit", "rows", "interval"])
}

/// A limit has a lower or an upper bound that something must keep.
fn is_limit(name: &str, fields: &BTreeSet<String>) -> bool {
    name.contains("Limit")
        && ["min", "max", "low", "high", "minimum", "maximum", "bound", "value"]
            .iter()
            .any(|f| fields.contains(*f))
}

fn one_word_constants(text: &str) -> usize {
    let named = |line: &str| -> Option<bool> {
        let line = line.trim_start();
        let line = line
            .strip_prefix("pub(crate) ")
            .or_else(|| line.strip_prefix("pub(super) "))
            .or_else(|| line.strip_prefix("pub "))
            .unwrap_or(line);
        let name = line.strip_prefix("const ").or_else(|| line.strip_prefix("static "))?.split(':').next()?;
        Some(name.len() > 1 && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit()))
    };
    text.lines().filter(|l| named(l) == Some(true)).count()
}

/// Doc comments whose subject is no thing: "What the sum is moved by".
fn dialect_comments(text: &str) -> usize {
    let dialect = |line: &&str| {
        let line = line.trim_start();
        let text = line
            .strip_prefix("/// What ")
            .or_else(|| line.strip_prefix("//! What "))
            .or_else(|| line.strip_prefix("// What "));
        text.is_some_and(|t| {
            t.split(|c: char| !c.is_alphanumeric())
                .any(|w| ["is", "are", "was", "were", "has", "have"].contains(&w))
        })
    };
    text.lines().filter(dialect).count()
}

/// Files and lines by package and its first folder.
fn rooms(product: &[&Source]) -> BTreeMap<String, (usize, usize)> {
    let mut rooms: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for source in product {
        let parts: Vec<&str> = source.path.split('/').collect();
        let depth = if parts[0] == "crates" { 4 } else { 2 };
        let folders = &parts[..parts.len() - 1];
        let room = rooms.entry(folders[..depth.min(folders.len())].join("/")).or_default();
        room.0 += 1;
        room.1 += source.product;
    }
    rooms
}

/// Lines of code of the modules that `sagnac run` leads to.
fn reached(root: &Path) -> io::Result<usize> {
    let packages = PACKAGES.map(|folder| Package::new(&root.join(folder)));
    let packages: Vec<Package> = packages.into_iter().collect::<io::Result<_>>()?;
    let uses: Vec<BTreeMap<&Module, BTreeSet<Module>>> = packages.iter().map(Package::uses).collect();
    let start = (0, vec!["cli".to_owned(), "run".to_owned()]);
    let (mut seen, mut open) = (BTreeSet::from([start.clone()]), vec![start]);
    while let Some((at, module)) = open.pop() {
        let own = uses[at].get(&module).into_iter().flatten().map(|next| (at, next.clone()));
        let mut next: Vec<(usize, Module)> = own.collect();
        for path in packages[at].text.get(&module).map(|text| modules::named(text)).unwrap_or_default() {
            let (package, rest) = path.split_once("::").unwrap_or((&path, ""));
            for (other, folder) in PACKAGES.iter().enumerate().skip(1) {
                let name = folder.trim_start_matches("crates/").trim_end_matches("/src").replace('-', "_");
                // The program re-exports modules of the core, and the core those of the packages that it stands on.
                let below_core = ["sagnac_base", "sagnac_explain", "sagnac_noise"].contains(&name.as_str());
                let reexported = match package {
                    "crate" => at == 0 || below_core,
                    "sagnac_core" => below_core,
                    _ => false,
                };
                if package == name || reexported {
                    next.extend(packages[other].target(rest).map(|module| (other, module)));
                }
            }
        }
        open.extend(next.into_iter().filter(|n| seen.insert(n.clone())));
    }
    let lines = |(at, module): &(usize, Module)| {
        let text = packages[*at].text.get(module).map(String::as_str).unwrap_or_default();
        text.lines().filter(|l| !l.trim().is_empty()).count()
    };
    Ok(seen.iter().map(lines).sum())
}

/// Medians of the files that a commit touches, by what it adds.
fn touched(root: &Path, since: &str) -> io::Result<Vec<(&'static str, String)>> {
    let since = format!("--since={since}");
    let log = ["log", "--no-merges", "--no-renames", "--format=commit %H", &since];
    let mut files: BTreeMap<String, usize> = BTreeMap::new();
    let mut commit = String::new();
    for line in git(root, &[&log[..], &["--name-only"]].concat())?.lines().filter(|l| !l.is_empty()) {
        match line.strip_prefix("commit ") {
            Some(hash) => hash.clone_into(&mut commit),
            None => *files.entry(commit.clone()).or_default() += 1,
        }
    }
    let mut kinds: BTreeSet<(&'static str, String)> = BTreeSet::new();
    let places = ["src/record", ":(glob)crates/*/src/measurand/**", ":(glob)crates/*/src/effect/kinds/**"];
    let mut path = String::new();
    for line in git(root, &[&log[..], &["--patch", "--unified=0", "--"], &places[..]].concat())?.lines() {
        let mut add = |kind| kinds.insert((kind, commit.clone()));
        if let Some(hash) = line.strip_prefix("commit ") {
            hash.clone_into(&mut commit);
        } else if let Some(name) = line.strip_prefix("+++ b/") {
            name.clone_into(&mut path);
        } else if line.starts_with("+    pub ")
            && line.contains(": ")
            && !line.contains("fn ")
            && path.starts_with("src/record/")
        {
            add("to add a field of a result");
        } else if line.starts_with('+') && path.contains("/measurand/") {
            add("by a change of a measurand");
        } else if line.starts_with('+') && path.contains("/effect/kinds/") {
            add("by a change of an effect");
        }
    }
    kinds.extend(files.keys().map(|commit| ("by any commit", commit.clone())));
    let mut counts: BTreeMap<&'static str, Vec<usize>> = BTreeMap::new();
    for (kind, commit) in kinds {
        counts.entry(kind).or_default().push(files.get(&commit).copied().unwrap_or_default());
    }
    let median = |mut of: Vec<usize>| {
        of.sort_unstable();
        format!("{} of {}", of.get(of.len() / 2).copied().unwrap_or_default(), of.len())
    };
    Ok(counts.into_iter().map(|(kind, of)| (kind, median(of))).collect())
}

/// Output of a git command in the root folder.
pub fn git(root: &Path, arguments: &[&str]) -> io::Result<String> {
    let output = Command::new("git").current_dir(root).args(arguments).output()?;
    if !output.status.success() {
        return Err(io::Error::other(String::from_utf8_lossy(&output.stderr).into_owned()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
