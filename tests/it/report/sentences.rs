//! No sentence that a user can see stands in the sources: all come from the tables of words.
//!
//! A text literal counts as a sentence when it holds three words or more beside each other. Left out are tests,
//! comments, attributes, and the meanings of the words of keys, which schema and guide show in English.

use std::path::{Path, PathBuf};

/// Files whose literals are English by design: file, why.
const ENGLISH: &[(&str, &str)] = &[
    ("src/config/procedure/model.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/tables/acceleration.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/tables/mod.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/tables/influence.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/tables/limits.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/tables/rate_table.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/tables/temperature.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/instrument.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/procedure/unit_facts.rs", "meanings of words of keys for the schema and the guide"),
    ("src/config/laboratory.rs", "meanings of words of keys: documentation, as of procedures"),
    ("src/store/index/", "statements of SQL"),
    ("src/config/procedure/guide.rs", "the guide is an English document"),
    ("src/config/procedure/schema.rs", "the schema is English"),
    ("crates/sagnac-core/src/measurand/", "descriptions of measurands for the schema and the guide"),
    ("crates/sagnac-core/src/evidence/test_evidence.rs", "evidence for tests"),
    ("crates/sagnac-ingest/src/named_file.rs", "the fault as the library says it; the program translates it"),
    ("src/config/syntax.rs", "what the TOML parser says, to be recognised"),
    ("crates/sagnac-core/src/c_header.rs", "declarations of a header in C"),
    ("src/report/methods.rs", "formulas and names of sources"),
    ("src/cli/mod.rs", "the help in English, which other languages translate"),
    ("src/lib.rs", "documentation"),
    ("src/config/recording_keys.rs", "meanings of words of keys: documentation, as of procedures"),
    ("src/config/bench/tables.rs", "meanings of words of keys of benches: documentation, as of procedures"),
    ("src/config/layout/tables.rs", "meanings of words of keys of layouts: documentation, as of procedures"),
    ("src/config/proof/tables.rs", "meanings of words of keys of proofs: documentation, as of procedures"),
    (
        "src/config/watch/tables.rs",
        "meanings of words of keys of watch rules: documentation, as of procedures",
    ),
    ("crates/sagnac-ingest/src/formats/sqlite_bag.rs", "queries of a database"),
    ("src/config/model/tables.rs", "meanings of words of keys of claims: documentation, as of procedures"),
    (
        "src/config/schedule/tables.rs",
        "meanings of words of keys of schedules: documentation, as of procedures",
    ),
    (
        "crates/sagnac-ingest/src/formats/matlab/element_reader.rs",
        "faults of the decoder, quoted as it says them",
    ),
    ("crates/sagnac-ingest/src/formats/matlab/v5.rs", "faults of the decoder, quoted as it says them"),
    ("crates/sagnac-ingest/src/binary/column_stream.rs", "faults of the decoder, quoted as it says them"),
    ("crates/sagnac-ingest/src/formats/tdms/mod.rs", "types of storage, quoted as the format names them"),
    ("crates/sagnac-ingest/src/formats/tdms/scale.rs", "faults of the decoder, quoted as it says them"),
    (
        "crates/sagnac-ingest/src/formats/hdf5/file_tree.rs",
        "types of storage, quoted as the format names them",
    ),
];

/// Single literals that are no sentence for users: file, part of the text, why.
const LITERALS: &[(&str, &str, &str)] = &[
    (
        "crates/sagnac-ingest/src/formats/parquet.rs",
        "the column holds no numbers",
        "a fault of the decoder, quoted as it says it",
    ),
    (
        "crates/sagnac-noise/src/noise/part.rs",
        "the later part continues a stretch",
        "a mistake of a program that merges parts, not of a user",
    ),
    ("src/report/svg/mod.rs", "system-ui", "names of fonts"),
    ("src/report/lot/mod.rs", "units small cards", "classes of a table in HTML"),
    ("src/report/view/evidence.rs", "dense clauses cards", "classes of a table in HTML"),
    ("src/report/view/further.rs", "measurands matrix cards", "classes of a table in HTML"),
    ("src/report/day/mod.rs", "units small cards", "classes of a table in HTML"),
    ("src/report/view/budget.rs", "units small cards", "classes of a table in HTML"),
    ("src/report/lot/quantity.rs", "units small cards", "classes of a table in HTML"),
    (
        "src/record/message.rs",
        "is not an argument of this presentation",
        "a fault of the reader of JSON, quoted as it says it",
    ),
    ("src/cli/demo.rs", "sagnac run static-bias", "a command line"),
    ("src/report/parameters/formats.rs", "import numpy as np", "a line of Python"),
    (
        "crates/sagnac-ingest/src/column_inference.rs",
        "the inside units are units",
        "a message of a programming error",
    ),
];

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
    out.sort();
}

/// The code of a file before its tests, without comments and attributes.
fn code(text: &str) -> String {
    let body = text.split("#[cfg(test)]\nmod tests").next().unwrap_or(text);
    let body = body.split("#[cfg(all(test, unix))]\nmod tests").next().unwrap_or(body);
    let body = body.split("#[cfg(test)]\n#[path").next().unwrap_or(body);
    let kept = body.lines().filter(|l| {
        let l = l.trim_start();
        !(l.starts_with("//") || l.starts_with("#[") || l.starts_with("#!["))
    });
    kept.collect::<Vec<_>>().join("\n")
}

/// Every text literal, with escapes as they are written.
fn literals(code: &str) -> Vec<String> {
    let (mut found, mut current): (Vec<String>, Option<String>) = (vec![], None);
    let chars: Vec<char> = code.chars().collect();
    let mut i = 0;
    while i < chars.len() {
        let c = chars[i];
        match (&mut current, c) {
            (Some(text), '\\') => {
                text.extend(chars.get(i + 1));
                i += 1;
            }
            (Some(_), '"') => found.extend(current.take()),
            (Some(text), c) => text.push(c),
            (None, '"') => current = Some(String::new()),
            // A character literal may hold a quotation mark.
            (None, '\'') if chars.get(i + 1) == Some(&'\\') && chars.get(i + 3) == Some(&'\'') => i += 3,
            (None, '\'') if chars.get(i + 2) == Some(&'\'') => i += 2,
            // A comment behind code ends with its line.
            (None, '/') if chars.get(i + 1) == Some(&'/') => {
                while i + 1 < chars.len() && chars[i + 1] != '\n' {
                    i += 1;
                }
            }
            (None, _) => {}
        }
        i += 1;
    }
    found
}

/// True for a text with three plain words beside each other.
fn is_sentence(text: &str) -> bool {
    let mut run = 0;
    for word in text.split([' ', '\n']) {
        let word = word.trim_matches(|c: char| ",.;:!?()".contains(c));
        let plain = word.len() > 1 && word.chars().all(|c| c.is_ascii_alphabetic() || c == '\'' || c == '-');
        let plain = plain || word == "a";
        run = if plain { run + 1 } else { 0 };
        if run == 3 {
            return true;
        }
    }
    false
}

fn found() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![];
    for folder in [
        "src",
        "crates/sagnac-base/src",
        "crates/sagnac-core/src",
        "crates/sagnac-explain/src",
        "crates/sagnac-ingest/src",
        "crates/sagnac-noise/src",
    ] {
        sources(&root.join(folder), &mut files);
    }
    let mut out = vec![];
    for path in files {
        let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
        if name.ends_with("tests.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        out.extend(literals(&code(&text)).into_iter().filter(|l| is_sentence(l)).map(|l| (name.clone(), l)));
    }
    out
}

#[test]
fn every_sentence_comes_from_the_tables() {
    let bare: Vec<(String, String)> = found()
        .into_iter()
        .filter(|(file, text)| {
            let whole = ENGLISH.iter().any(|(f, _)| f == file || f.ends_with('/') && file.starts_with(f));
            let single = LITERALS.iter().any(|(f, part, _)| f == file && text.contains(part));
            !whole && !single
        })
        .collect();
    assert!(bare.is_empty(), "put these into templates/locale: {bare:#?}");
}

#[test]
fn the_allow_lists_hold_nothing_idle() {
    let found = found();
    for (file, part, why) in LITERALS {
        assert!(found.iter().any(|(f, text)| f == file && text.contains(part)), "{file}: {part} ({why})");
    }
    for (file, why) in ENGLISH {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(file).exists(), "{file} ({why})");
    }
}

#[test]
fn the_search_finds_sentences_and_only_those() {
    let code = code(
        "let a = \"no such thing\"; // \"a comment here too\"\nlet c = '\"'; let d = \"x y\";\n/// \"a doc comment here\"",
    );
    assert_eq!(literals(&code), ["no such thing", "x y"]);
    assert!(is_sentence("{path}: no column looks like") && is_sentence("must be a count"));
    assert!(
        !is_sentence("keyed.help.example") && !is_sentence("{:<52} {:>16}") && !is_sentence("NIST SP 1065")
    );
}
