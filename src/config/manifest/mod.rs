//! Manifests: the files of a recording in their order, with what must be known to read them.
//!
//! A manifest is checked as a whole before a file is read: every problem has its place in it.

pub mod tables;

use crate::config::contained_files::{self, ContainedFile};
use crate::config::diagnostics::{Problems, Span};
use crate::config::external;
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::i18n::{Note, note};
use crate::record::UnitUnderTest;
use sagnac_ingest::layout::LayoutFile;
use sagnac_ingest::multi_file::PartSpec;
use sagnac_ingest::pattern::natural;
use sagnac_ingest::{ReadOptions, SecondSource, TextOptions, byte_stream, pattern};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tables::{FileKeys, MANIFEST_FILE, ManifestTables, ReadingKeys, SourceKeys, UnitKeys};

/// Messages for a manifest that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "manifest.unreadable", folder: "text_file.no_manifest" };

/// A manifest.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// The manifest file, as given.
    pub path: PathBuf,
    /// Serial number of the unit that was recorded.
    pub serial: Option<String>,
    /// Further facts of the unit.
    pub unit: UnitUnderTest,
    /// True when each file follows the one before without a gap.
    pub contiguous: bool,
    /// How the files are to be read.
    pub options: ReadOptions,
    /// The files, in order.
    pub files: Vec<ManifestFile>,
}

/// One file of a manifest.
#[derive(Debug, Clone, PartialEq)]
pub struct ManifestFile {
    /// Path as it can be opened.
    pub path: PathBuf,
    /// SHA-256 stated for it, hexadecimal.
    pub sha256: Option<String>,
    /// Phase of the test that it belongs to.
    pub phase: Option<String>,
}

impl Manifest {
    /// The files to be joined.
    pub fn parts(&self) -> Vec<PartSpec> {
        let part = |f: &ManifestFile| PartSpec {
            path: f.path.clone(),
            sha256: f.sha256.clone(),
            phase: f.phase.clone(),
        };
        self.files.iter().map(part).collect()
    }

    /// Decisions of the manifest, over those made elsewhere.
    pub fn options_over(&self, other: &ReadOptions) -> ReadOptions {
        let (own, text) = (self.options.clone(), self.options.text.clone());
        ReadOptions {
            format: own.format.or_else(|| other.format.clone()),
            text: TextOptions {
                encoding: text.encoding.or(other.text.encoding),
                delimiter: text.delimiter.or(other.text.delimiter),
                decimal: text.decimal.or(other.text.decimal),
                header_line: text.header_line.or(other.text.header_line),
                first_line: text.first_line.or(other.text.first_line),
                comment: text.comment.or_else(|| other.text.comment.clone()),
                stamps: other.text.stamps.clone(),
            },
            part: own.part.or_else(|| other.part.clone()),
            layout: own.layout.or_else(|| other.layout.clone()),
            time_unit: own.time_unit.or_else(|| other.time_unit.clone()),
            only: own.only.or_else(|| other.only.clone()),
            rows: own.rows.or(other.rows),
            sources: if own.sources.is_empty() { other.sources.clone() } else { own.sources },
        }
    }
}

/// True when a file says at its beginning that it is a manifest, or is named like one and is no other kind of TOML.
pub fn is_manifest(path: &Path) -> bool {
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) {
        return false;
    }
    let Some(text) = text_file::peek(path) else { return false };
    let said = text.lines().map(str::trim).find_map(|l| l.strip_prefix("format"));
    said.map_or_else(|| path.file_stem().is_some_and(|s| s == "manifest"), |rest| rest.contains("manifest/"))
}

/// Reads a manifest and checks that its files are there and are what it says.
///
/// # Errors
/// Every problem, each with its place.
pub fn load(path: &Path) -> Result<Manifest, Problems> {
    parse(
        path,
        &path.display().to_string(),
        &text_file::bytes(path, &READ_MESSAGES)?,
        contained_files::folder_of(path),
    )
}

/// Reads a manifest from its bytes; its files are looked for in `folder`.
///
/// # Errors
/// As [`load`].
pub fn parse(path: &Path, name: &str, bytes: &[u8], folder: &Path) -> Result<Manifest, Problems> {
    let (manifest, problems) = checked(&text_file::source(name, bytes)?, &MANIFEST_FILE, |root, reader| {
        let mut tables = ManifestTables::read(root);
        Manifest {
            path: path.to_owned(),
            serial: tables.serial.take(),
            unit: UnitUnderTest {
                external: external::results(&tables.externals, reader),
                ..std::mem::take(&mut tables.unit).into()
            },
            contiguous: tables.contiguous,
            options: ReadOptions {
                sources: sources(std::mem::take(&mut tables.sources), folder, reader),
                ..options(std::mem::take(&mut tables.recording), folder, reader)
            },
            files: files(tables, folder, reader),
        }
    });
    manifest.ok_or(problems)
}

impl From<UnitKeys> for UnitUnderTest {
    /// The unit without its serial number.
    fn from(keys: UnitKeys) -> UnitUnderTest {
        UnitUnderTest {
            model: keys.model,
            lot: keys.lot,
            build_date: keys.build_date.map(|d| d.to_string()),
            reference: keys.reference,
            attributes: keys.attributes.into_iter().map(|a| (a.name, a.value)).collect(),
            ..UnitUnderTest::default()
        }
    }
}

fn complain(reader: &mut Reader<'_>, span: &Span, note: Note, help: Option<&'static str>) {
    reader.error(span, note, help.map(Note::new));
}

fn files(tables: ManifestTables, folder: &Path, reader: &mut Reader<'_>) -> Vec<ManifestFile> {
    let root = &tables.section;
    match (&tables.files, root.entry("file").is_some()) {
        (Some(_), true) => {
            let at = root.span_of("files");
            complain(reader, &at, note!("manifest.both"), Some("manifest.help.both"));
            vec![]
        }
        (None, false) => {
            // A wrong value of `files` has been reported already.
            if root.entry("files").is_none() {
                complain(
                    reader,
                    &root.span.clone(),
                    note!("manifest.no_files"),
                    Some("manifest.help.no_files"),
                );
            }
            vec![]
        }
        (Some(pattern), false) => by_pattern(pattern, &root.span_of("files"), folder, reader),
        (None, true) => by_list(tables.listed, tables.several_phases, folder, reader),
    }
}

fn by_list(
    listed: Vec<FileKeys>,
    several_phases: bool,
    folder: &Path,
    reader: &mut Reader<'_>,
) -> Vec<ManifestFile> {
    let mut found: Vec<ManifestFile> = Vec::new();
    let mut real: BTreeMap<PathBuf, usize> = BTreeMap::new();
    let most = sagnac_ingest::multi_file::MAX_FILES;
    if let Some(beyond) = listed.get(most) {
        complain(reader, &beyond.section.span, note!("manifest.too_many", most), None);
        return found;
    }
    for FileKeys { path, sha256, phase, section } in listed {
        let Some(text) = path else { continue };
        let at = reader.source.inside_quotes(&section.span_of("path"));
        let Some(ContainedFile { path, canonical }) = contained_files::file(&text, folder, &at, reader)
        else {
            continue;
        };
        if let Some(line) = real.get(&canonical) {
            let note = note!("manifest.twice", path = text.as_str(), line = *line);
            complain(reader, &at, note, Some("manifest.help.twice"));
            continue;
        }
        real.insert(canonical, reader.source.error(&at, "").line);
        let sha256 = sha256.filter(|stated| hash_holds(stated, &path, &section, reader));
        if let Some(other) = found.last().filter(|f| f.phase != phase && !several_phases) {
            let span = if phase.is_some() { section.span_of("phase") } else { section.span.clone() };
            let word = |p: &Option<String>| p.clone().unwrap_or_else(|| "-".to_owned());
            let note = note!("manifest.phases", phase = word(&phase), other = word(&other.phase));
            complain(reader, &reader.source.inside_quotes(&span), note, Some("manifest.help.phases"));
        }
        found.push(ManifestFile { path, sha256, phase });
    }
    found
}

/// True when a stated hash is that of the file.
fn hash_holds(stated: &str, path: &Path, section: &Section, reader: &mut Reader<'_>) -> bool {
    let at = reader.source.inside_quotes(&section.span_of("sha256"));
    if stated.len() != 64 || !stated.chars().all(|c| c.is_ascii_hexdigit()) {
        complain(reader, &at, note!("manifest.no_hash"), Some("manifest.help.no_hash"));
        return false;
    }
    match byte_stream::digest(path) {
        Ok(found) if found.sha256.eq_ignore_ascii_case(stated) => true,
        Ok(found) => {
            let note = note!("manifest.wrong_hash", path = path.display().to_string(), found = found.sha256);
            complain(reader, &at, note, Some("manifest.help.wrong_hash"));
            false
        }
        Err(e) => {
            complain(reader, &at, note!("manifest.unreadable", reason = e.note()), None);
            false
        }
    }
}

fn by_pattern(pattern: &str, span: &Span, folder: &Path, reader: &mut Reader<'_>) -> Vec<ManifestFile> {
    let at = reader.source.inside_quotes(span);
    if !contained_files::stays(pattern, &at, reader) {
        return vec![];
    }
    let most = sagnac_ingest::multi_file::MAX_FILES;
    let mut names = match pattern::files(&contained_files::joined(folder, ""), pattern, most) {
        Ok(names) => names,
        Err(e) => {
            complain(reader, &at, e.note("manifest.bad_pattern", "manifest.wide_pattern"), None);
            return vec![];
        }
    };
    names.sort_by_cached_key(|f| natural(&f.to_string_lossy()));
    if names.is_empty() {
        let note = note!("manifest.no_match", folder = folder.display().to_string());
        complain(reader, &at, note, Some("manifest.help.no_match"));
    } else if names.len() > most {
        complain(reader, &at, note!("manifest.too_many", most), None);
        return vec![];
    }
    let mut found = Vec::new();
    for path in names {
        let relative = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
        if let Some(file) = contained_files::file(&relative, folder, &at, reader) {
            found.push(ManifestFile { path: file.path, sha256: None, phase: None });
        }
    }
    found
}

/// The files that were recorded beside the recording.
fn sources(listed: Vec<SourceKeys>, folder: &Path, reader: &mut Reader<'_>) -> Vec<SecondSource> {
    let mut found = Vec::new();
    for SourceKeys {
        path,
        files,
        sha256,
        time_offset_s,
        time_offset_uncertainty_s,
        estimate_offset,
        time_rate,
        section,
    } in listed
    {
        let paths: Vec<PathBuf> = match (path, files) {
            (Some(_), Some(_)) => {
                let at = section.span_of("files");
                complain(reader, &at, note!("manifest.two_sources"), Some("manifest.help.two_sources"));
                continue;
            }
            (Some(text), None) => {
                let at = reader.source.inside_quotes(&section.span_of("path"));
                contained_files::file(&text, folder, &at, reader).into_iter().map(|file| file.path).collect()
            }
            (None, Some(_)) if sha256.is_some() => {
                let at = section.span_of("sha256");
                complain(reader, &at, note!("manifest.hash_of_several"), None);
                continue;
            }
            (None, Some(pattern)) => {
                let found = by_pattern(&pattern, &section.span_of("files"), folder, reader);
                found.into_iter().map(|file| file.path).collect()
            }
            (None, None) => {
                // A wrong value has been reported already.
                if section.entry("path").is_none() && section.entry("files").is_none() {
                    let note = note!("manifest.no_source");
                    complain(reader, &section.span.clone(), note, Some("manifest.help.no_source"));
                }
                continue;
            }
        };
        let Some((path, more)) = paths.split_first().map(|(path, more)| (path.clone(), more.to_vec())) else {
            continue;
        };
        if sha256.is_none_or(|stated| hash_holds(&stated, &path, &section, reader)) {
            let (offset_s, estimate) = (time_offset_s, estimate_offset);
            let offset_uncertainty_s = time_offset_uncertainty_s;
            let source =
                SecondSource { path, more, offset_s, rate: time_rate, offset_uncertainty_s, estimate };
            found.push(source);
        }
    }
    found
}

fn options(keys: ReadingKeys, folder: &Path, reader: &mut Reader<'_>) -> ReadOptions {
    let layout = keys.layout.and_then(|text| {
        let at = reader.source.inside_quotes(&keys.section.span_of("layout"));
        contained_files::file(&text, folder, &at, reader).map(|f| LayoutFile::at(f.path))
    });
    ReadOptions { layout, ..keys.reading.options(&keys.section, reader) }
}
