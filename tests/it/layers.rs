//! Modules depend downwards only: the table is the architecture, a module that reaches up fails here. Effects are referred to by
//! their properties and not by name. Documents name what there is.

use sagnac::effect::EFFECTS;
use sagnac_studies::pages::GENERATED;
use sagnac_studies::{STUDIES, index};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const BASE: &str = "crates/sagnac-base/src";
const NOISE: &str = "crates/sagnac-noise/src";
const EXPLAIN: &str = "crates/sagnac-explain/src";
const CORE: &str = "crates/sagnac-core/src";

/// A package, its folder of sources, and its rooms from the ground up; each may use those of lower floors, and its own.
/// That the packages depend downwards only is enforced by cargo.
const PACKAGES: &[(&str, &[&[&str]])] = &[
    (
        BASE,
        &[
            &["real", "visible", "spelling", "local_text"],
            &["message"],
            &["render"],
            &["numeric", "units"],
            &["estimate", "figure"],
            &["recording"],
        ],
    ),
    (NOISE, &[&["noise"]]),
    (EXPLAIN, &[&["effect"], &["claim", "series"], &["schedule"], &["mismatch", "simulate"], &["plan"]]),
    (
        CORE,
        &[
            &["c_header", "formula", "lot"],
            &["rate_table", "start_up", "temperature"],
            &["influence"],
            &["evidence"],
            &["criticism"],
            &["measurand"],
        ],
    ),
    (
        "src",
        &[
            &["confined", "executable", "i18n", "manual", "moment"],
            &["output"],
            &["record", "signing"],
            &["config"],
            &["ingest"],
            &["series", "store"],
            &["simulate"],
            &["acceptance", "selftest"],
            &["report"],
            &["library", "prove", "rehearse", "verify", "watch"],
            &["cli"],
        ],
    ),
];

/// Modules of lower packages that the program re-exports.
const FACADE: &[&str] = &[
    "claim",
    "criticism",
    "effect",
    "estimate",
    "evidence",
    "figure",
    "formula",
    "influence",
    "lot",
    "measurand",
    "mismatch",
    "noise",
    "numeric",
    "plan",
    "rate_table",
    "recording",
    "schedule",
    "start_up",
    "temperature",
    "units",
];

fn floor(floors: &[&[&str]], module: &str) -> Option<usize> {
    floors.iter().position(|f| f.contains(&module))
}

/// Whether a package re-exports this module of a lower one.
fn is_reexported(folder: &str, module: &str) -> bool {
    let lower: &[&str] = match folder {
        "src" => return FACADE.contains(&module),
        CORE | EXPLAIN => &[BASE, NOISE],
        NOISE => &[BASE],
        _ => &[],
    };
    PACKAGES.iter().any(|(package, floors)| lower.contains(package) && floor(floors, module).is_some())
}

/// The files below a folder whose name ends in `.extension`.
fn files_below(folder: &Path, extension: &str, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files_below(&path, extension, out);
        } else if path.extension().is_some_and(|e| e == extension) {
            out.push(path);
        }
    }
}

/// The modules that a source text names after `crate::`.
fn uses(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices("crate::") {
        let rest = &text[at + "crate::".len()..];
        if let Some(group) = rest.strip_prefix('{') {
            let body = group.split('}').next().unwrap_or_default();
            found
                .extend(body.split(',').filter_map(|item| item.trim().split("::").next()).map(str::to_owned));
        } else {
            found.push(rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect());
        }
    }
    found
}

#[test]
fn every_module_stands_on_a_floor_and_looks_down_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut checked, mut wrong) = (0, Vec::new());
    for (folder, floors) in PACKAGES {
        let src = root.join(folder);
        let mut files = Vec::new();
        files_below(&src, "rs", &mut files);
        for file in files {
            let relative = file.strip_prefix(&src).unwrap();
            let first = relative.components().next().unwrap().as_os_str().to_string_lossy().into_owned();
            let module = first.trim_end_matches(".rs");
            if ["lib", "main"].contains(&module) {
                continue;
            }
            let Some(own) = floor(floors, module) else {
                wrong.push(format!("{folder}: {module} stands on no floor"));
                continue;
            };
            for used in uses(&fs::read_to_string(&file).unwrap()) {
                checked += 1;
                let below = is_reexported(folder, &used);
                match floor(floors, &used) {
                    _ if below || used == module => {}
                    Some(other) if other < own => {}
                    Some(_) => {
                        wrong.push(format!("{} uses {used}, which is not below {module}", relative.display()))
                    }
                    None => {
                        wrong.push(format!("{} uses crate::{used}, which is no module", relative.display()))
                    }
                }
            }
        }
    }
    assert!(checked > 50, "the search found only {checked} uses");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Ids of effects that are ids of other things too: of measurands, parts of a noise model, tests of a residual, arguments of texts.
const IDS_WITH_OTHER_MEANINGS: &[&str] = &[
    "comb",
    "cross_axis",
    "dead_zone",
    "line",
    "quantization",
    "quasi_periodic",
    "rate_ramp",
    "sf_error",
    "sf_nonlinearity",
    "supply_sensitivity",
    "table_harmonic",
    "thermal_lag",
];

/// The rooms in which such an id can only be that of the effect.
const ROOMS_OF_EFFECTS: &[&str] = &["claim", "effect", "mismatch", "plan", "schedule", "simulate"];

/// Source text without its unit tests.
fn product_text(file: &Path) -> String {
    let name = file.file_stem().unwrap().to_string_lossy();
    if name.ends_with("tests") || name == "truths" {
        return String::new();
    }
    fs::read_to_string(file).unwrap().split("#[cfg(test)]").next().unwrap_or_default().to_owned()
}

#[test]
fn no_effect_is_referred_to_by_name_outside_its_own_file() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut described, mut wrong) = (BTreeSet::new(), Vec::new());
    for folder in PACKAGES.iter().map(|(folder, _)| *folder).chain(["crates/sagnac-ingest/src"]) {
        let src = root.join(folder);
        let mut files = Vec::new();
        files_below(&src, "rs", &mut files);
        for file in files {
            let relative = file.strip_prefix(&src).unwrap().to_string_lossy().into_owned();
            let of_effects = folder == EXPLAIN
                && ROOMS_OF_EFFECTS.iter().any(|room| relative.starts_with(room))
                && !relative.starts_with("mismatch/departures");
            let text = product_text(&file);
            for id in EFFECTS.iter().map(|e| e.kind()) {
                let quoted = format!("\"{id}\"");
                let is_own = ["Mean", "Spectrum", "Samples"]
                    .iter()
                    .any(|class| text.contains(&format!("{quoted}, {class} in ")));
                if is_own {
                    described.insert(id);
                } else if text.contains(&quoted) && (of_effects || !IDS_WITH_OTHER_MEANINGS.contains(&id)) {
                    wrong.push(format!("{folder}/{relative} names {id}"));
                }
            }
        }
    }
    assert_eq!(described.len(), EFFECTS.len(), "each effect has one file");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The documents, and the folder that each target of cargo has its file in.
const DOCUMENTS: &[&str] = &["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "samples/README.md", "docs"];
const TARGETS: &[(&str, &str)] = &[("--test ", "tests"), ("--bench ", "benches"), ("--example ", "examples")];

#[test]
fn the_summary_of_validation_has_what_every_page_misses() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation");
    let summary = fs::read_to_string(folder.join("README.md")).unwrap();
    let pages = index::read_pages(&folder).unwrap();
    for (name, page) in &pages {
        let written_by_a_study = page.contains(GENERATED);
        assert!(
            written_by_a_study || summary.contains(&format!("]({name})")),
            "{name} is not in the summary"
        );
        let study = STUDIES.iter().any(|s| name.strip_suffix(".md") == Some(s.id));
        assert!(written_by_a_study || !study, "{name} is kept by hand and has the name of a study");
    }
    let expected = index::with_misses(&summary, &pages).unwrap();
    assert!(summary == expected, "`cargo xtask validate --index` writes it anew");
}

#[test]
fn studies_and_their_cases_have_names_of_their_own_and_stand_in_the_summary() {
    let summary = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation/README.md");
    let summary = fs::read_to_string(summary).unwrap();
    let mut ids = BTreeSet::new();
    for study in STUDIES {
        assert!(ids.insert(study.id), "two studies are named {}", study.id);
        assert!(summary.contains(&format!("`cargo xtask validate {}`", study.id)), "{}", study.id);
        let cases = (study.cases)();
        let names: BTreeSet<&str> = cases.iter().map(|c| c.name.as_str()).collect();
        assert!(!cases.is_empty() && names.len() == cases.len(), "{}", study.id);
    }
}

#[test]
fn documents_name_tests_that_there_are() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents = Vec::new();
    for name in DOCUMENTS.iter().map(|d| root.join(d)) {
        if name.is_dir() {
            files_below(&name, "md", &mut documents);
        } else {
            documents.push(name);
        }
    }
    let (mut named, mut missing) = (0, Vec::new());
    for document in &documents {
        // A command may go on in the next line.
        let text = fs::read_to_string(document).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
        for (option, folder) in TARGETS {
            for rest in text.split(option).skip(1) {
                let target: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                // The archive is a workspace of its own.
                let places = [root.join(folder), root.join("crates/sagnac-archive").join(folder)];
                let there = |folder: &PathBuf| {
                    let at = folder.join(&target);
                    at.with_extension("rs").exists() || at.join("main.rs").exists()
                };
                named += 1;
                if target.is_empty() || !places.iter().any(there) {
                    missing.push(format!("{}: {option}{target}", document.display()));
                }
            }
        }
        // A path with a choice in it is one of another project.
        let ours = |part: &&str| ["tests/", "studies/"].iter().any(|folder| part.starts_with(folder));
        for rest in text.split('`').filter(ours).filter(|part| !part.contains(['{', '<'])) {
            let path = rest.split_whitespace().next().unwrap_or_default();
            named += 1;
            if !root.join(path).exists() {
                missing.push(format!("{}: {path}", document.display()));
            }
        }
    }
    assert!(named > 30, "the search found only {named} commands");
    assert!(missing.is_empty(), "{missing:#?}");
}
