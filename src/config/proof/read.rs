//! A proof file, with every problem at its place.

use super::tables::{ClaimKeys, DecoyKeys, PROOF_FILE, ProofTables, RecordingKeys, ReferenceKeys, RuleKeys};
use super::{ClaimSource, Decoy, Must, Part, ProofFile, Reference, Rule, Shown, Source};
use crate::config::contained_files::{self, folder_of};
use crate::config::diagnostics::Problems;
use crate::config::procedure::channel;
use crate::config::read_tables::checked;
use crate::config::reader::{Reader, for_example};
use crate::config::section::Section;
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::i18n::note;
use std::path::{Path, PathBuf};

/// Messages for a proof file that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "proof_file.unreadable", folder: "proof_file.folder" };

/// Reads a proof file.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<ProofFile, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &READ_MESSAGES)?, folder_of(path))
}

/// Reads a proof file from its bytes; `name` stands in diagnostics, and the models that it names are looked for in `folder`.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8], folder: &Path) -> Result<ProofFile, Problems> {
    let build = |root: &Section, reader: &mut Reader<'_>| build(root, folder, reader);
    let (proof, problems) = checked(&text_file::source(name, bytes)?, &PROOF_FILE, build);
    proof.flatten().ok_or(problems)
}

fn build(root: &Section, folder: &Path, reader: &mut Reader<'_>) -> Option<ProofFile> {
    let tables = ProofTables::read(root);
    let (recording, conceal) = (tables.recording?, tables.conceal);
    let channels: Vec<_> =
        tables.channels.iter().filter_map(|keys| channel::read(keys, reader)).map(|(c, _)| c).collect();
    let references: Vec<Reference> =
        tables.references.into_iter().filter_map(|keys| reference(keys, reader)).collect();
    let hidden = conceal.columns;
    let rules =
        tables.rules.into_iter().filter_map(|keys| rule(keys, &references, &hidden, reader)).collect();
    Some(ProofFile {
        title: tables.title?,
        question: tables.question?,
        source: source(&recording, folder, reader)?,
        seed: recording.seed,
        channels,
        part: part(recording.from_s, recording.to_s, &recording.section, reader),
        rate: recording.rate,
        unit: recording.unit,
        sample_rate_hz: recording.sample_rate_hz,
        average: recording.average,
        added: conceal.effects.and_then(|text| model(&text, &conceal.section, "effects", folder, reader)),
        hidden_columns: hidden,
        decoys: tables.decoys.into_iter().filter_map(decoy).collect(),
        claim: claim(tables.claim?, folder, reader),
        references,
        rules,
    })
}

/// A model that a key names.
fn model(
    text: &str,
    section: &Section,
    key: &str,
    folder: &Path,
    reader: &mut Reader<'_>,
) -> Option<PathBuf> {
    let at = reader.source.inside_quotes(&section.span_of(key));
    contained_files::file(text, folder, &at, reader).map(|f| f.path)
}

fn source(recording: &RecordingKeys, folder: &Path, reader: &mut Reader<'_>) -> Option<Source> {
    let section = &recording.section;
    let simulated = section.entry("simulated").is_some();
    if recording.path.is_some() == simulated {
        reader.error(&section.span, "proof_file.path_or_simulated", None);
        return None;
    }
    let Some(path) = &recording.path else {
        let Some(duration_s) = recording.duration_s else {
            missing(section, "duration", reader);
            return None;
        };
        let text = recording.simulated.as_deref()?;
        return Some(Source::Simulated {
            model: model(text, section, "simulated", folder, reader)?,
            duration_s,
        });
    };
    let at = reader.source.inside_quotes(&section.span_of("path"));
    if !contained_files::stays(path, &at, reader) {
        return None;
    }
    let Some(sha256) = &recording.sha256 else {
        missing(section, "sha256", reader);
        return None;
    };
    Some(Source::File { path: path.clone(), sha256: sha256.to_lowercase() })
}

/// Says that a table lacks a key that goes with what it says.
fn missing(section: &Section, key: &'static str, reader: &mut Reader<'_>) {
    let spec = PROOF_FILE.walk().into_iter().find_map(|t| t.key(key));
    reader.error(&section.span, note!("proof_file.lacks", key), spec.map(for_example));
}

fn part(from_s: Option<f64>, to_s: Option<f64>, section: &Section, reader: &mut Reader<'_>) -> Part {
    if from_s.zip(to_s).is_some_and(|(from, to)| from >= to) {
        reader.error(&section.span_of("to"), "proof_file.to_before_from", None);
    }
    Part { from_s, to_s }
}

fn decoy(keys: DecoyKeys) -> Option<Decoy> {
    Some(Decoy { name: keys.name?, of: keys.of?, shift_s: keys.shift_s? })
}

fn claim(keys: ClaimKeys, folder: &Path, reader: &mut Reader<'_>) -> ClaimSource {
    let section = &keys.section;
    if section.entry("model").is_none() {
        let part = part(keys.from_s, keys.to_s, section, reader);
        return ClaimSource::Identified { part, rate: keys.rate };
    }
    if let Some(key) = ["from", "to", "rate"].into_iter().find(|k| section.entry(k).is_some()) {
        reader.error(&section.span_of(key), note!("proof_file.model_and", key), None);
    }
    let named = keys.model.and_then(|text| model(&text, section, "model", folder, reader));
    ClaimSource::Model(named.unwrap_or_default())
}

fn reference(keys: ReferenceKeys, reader: &mut Reader<'_>) -> Option<Reference> {
    let interval = match (keys.low, keys.high, keys.unit) {
        (Some(low), Some(high), Some(unit)) if low <= high => Some(([low, high], unit)),
        (None, None, None) => None,
        _ => {
            reader.error(&keys.section.span, "proof_file.interval", None);
            return None;
        }
    };
    Some(Reference { id: keys.id?, what: keys.what?, interval, source: keys.source? })
}

fn rule(
    keys: RuleKeys,
    references: &[Reference],
    hidden: &[String],
    reader: &mut Reader<'_>,
) -> Option<Rule> {
    let section = &keys.section;
    let when = if keys.when == Shown::Unveiled.id() { Shown::Unveiled } else { Shown::Concealed };
    if when == Shown::Unveiled && hidden.is_empty() {
        reader.error(&section.span_of("when"), "proof_file.nothing_unveiled", None);
    }
    let must = keys.must?;
    let needs: &[&'static str] = match must {
        "verdict" => &["verdicts"],
        "name" | "not_name" => &["kinds"],
        "follow" | "not_follow" => &["columns"],
        "parameter" => &["kinds", "parameter", "reference"],
        "locate" => &["domain", "low", "high"],
        "course" => &["columns", "at_least"],
        _ => &["at_least"],
    };
    for key in ["verdicts", "kinds", "columns", "parameter", "reference", "domain", "low", "high", "at_least"]
    {
        let given = section.entry(key).is_some();
        if needs.contains(&key) && !given {
            missing(section, key, reader);
            return None;
        }
        if given && !needs.contains(&key) {
            let note = note!("proof_file.foreign", must, key);
            reader.error(&section.span_of(key), note, None);
        }
    }
    let at_least = keys.at_least.unwrap_or(0.0);
    let must = match must {
        "verdict" => Must::Verdict(keys.verdicts?),
        "name" => Must::Name(keys.kinds),
        "not_name" => Must::NotName(keys.kinds),
        "follow" => Must::Follow(keys.columns),
        "not_follow" => Must::NotFollow(keys.columns),
        "parameter" => {
            let id = keys.reference?;
            let place = references.iter().position(|r| r.id == id && r.interval.is_some());
            let Some(reference) = place else {
                let at = reader.source.inside_quotes(&section.span_of("reference"));
                reader.error(&at, note!("proof_file.no_reference", id), None);
                return None;
            };
            Must::Parameter { kinds: keys.kinds, parameter: keys.parameter?, reference }
        }
        "locate" => {
            let (domain, low, high) = (keys.domain?, keys.low?, keys.high?);
            if low > high {
                reader.error(&section.span_of("high"), "proof_file.interval", None);
            }
            Must::Locate { domain, low, high }
        }
        "course" => Must::Course { columns: keys.columns, at_least },
        "improve" => Must::Improve(at_least),
        _ => Must::Recover(at_least),
    };
    Some(Rule { when, must })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::proof::tables::{LOCATION_DOMAINS, RULE_KINDS};
    use crate::effect::Domain;

    const TEXT: &str = r#"format = "proof/1"
title = "Ramp"
question = "Is it found?"

[recording]
path = "fog/a.csv"
sha256 = "AB"
from = "10 s"
to = "1 h"

[conceal]
columns = ["ramp"]

[[decoy]]
name = "d"
of = "ramp"
shift = "2 min"

[claim]
to = "10 min"

[[reference]]
id = "f"
what = "Frequency"
low = 4.1
high = 4.2
unit = "Hz"
source = "README"

[[rule]]
must = "parameter"
kinds = ["comb"]
parameter = "frequency_hz"
reference = "f"

[[rule]]
when = "unveiled"
must = "follow"
columns = ["ramp"]
"#;

    fn said(text: &str) -> String {
        parse("p.toml", text.as_bytes(), Path::new(".")).unwrap_err().to_string()
    }

    #[test]
    fn a_proof_is_read_as_it_says() {
        let read = parse("p.toml", TEXT.as_bytes(), Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read.source, Source::File { path: "fog/a.csv".into(), sha256: "ab".into() });
        assert_eq!(read.part, Part { from_s: Some(10.0), to_s: Some(3600.0) });
        assert_eq!(read.decoys[0].shift_s, 120.0);
        let ClaimSource::Identified { part, rate } = &read.claim else { panic!("{:?}", read.claim) };
        assert_eq!((part.to_s, rate), (Some(600.0), &None));
        assert_eq!(read.rules[1], Rule { when: Shown::Unveiled, must: Must::Follow(vec!["ramp".into()]) });
        assert!(matches!(&read.rules[0].must, Must::Parameter { reference: 0, .. }));
    }

    #[test]
    fn problems_have_their_places() {
        for (from, to, place) in [
            ("sha256 = \"AB\"\n", "", "p.toml:5:2"),
            ("path = \"fog/a.csv\"", "path = \"../a.csv\"", "p.toml:6:9"),
            ("to = \"1 h\"", "to = \"1 s\"", "p.toml:9:6"),
            ("reference = \"f\"", "reference = \"g\"", "p.toml:34:14"),
            ("\"comb\"", "\"combb\"", "p.toml:32:11"),
            ("columns = [\"ramp\"]\n\n[[decoy]]", "[[decoy]]", "p.toml:35:8"),
            ("parameter = \"frequency_hz\"\n", "", "p.toml:30:1"),
            ("high = 4.2", "high = 4.0", "p.toml:22:1"),
            ("[claim]\n", "[claim]\nmodel = \"none.toml\"\n", "p.toml:20:10"),
        ] {
            assert!(TEXT.contains(from), "{from}");
            let said = said(&TEXT.replacen(from, to, 1));
            assert!(said.contains(place), "{to}: {said}");
        }
    }

    #[test]
    fn every_domain_and_rule_has_its_word() {
        assert!(LOCATION_DOMAINS.iter().map(|w| w.0).eq(Domain::ALL.iter().map(|d| d.id())));
        for (must, _) in RULE_KINDS {
            let text = TEXT.replace("must = \"follow\"", &format!("must = \"{must}\""));
            let read = parse("p.toml", text.as_bytes(), Path::new("."));
            assert_eq!(read.is_ok(), must.ends_with("follow"), "{must}");
        }
    }
}
