//! From what a user names to one recording: a file, several files, a pattern, a manifest.

use super::multi_file::{self, PartSpec};
use super::{IngestError, IngestErrorKind};
use super::{ReadOptions, Source};
use crate::config::diagnostics::Problems;
use crate::config::layout::{self, refused};
use crate::config::manifest::{self, Manifest};
use crate::i18n::{Lang, Localize, Note, note};
use sagnac_ingest::{SecondSource, beside, pattern};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An opened recording and what its manifest says beside.
pub struct Recording {
    /// The recording.
    pub source: Source,
    /// The manifest, where there is one.
    pub manifest: Option<Manifest>,
}

/// Why a recording could not be opened.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordingError {
    /// One of its files.
    File(IngestError),
    /// Its manifest.
    Manifest(Problems),
}

impl RecordingError {
    /// The error as one of reading; of a manifest, its first problem.
    pub fn into_ingest(self, path: &Path) -> IngestError {
        match self {
            RecordingError::File(e) => e,
            RecordingError::Manifest(problems) => {
                let first = problems.list.first();
                let reason = first.map_or_else(|| note!("ingest.joined.no_reason"), |p| p.message.clone());
                let note = note!("ingest.joined.manifest", reason);
                let error = IngestError::new(IngestErrorKind::Parts, path, note);
                match first.filter(|p| p.line > 0) {
                    Some(p) => error.at(p.line as u64, Some(p.column as u64)),
                    None => error,
                }
            }
        }
    }
}

impl RecordingError {
    /// The diagnostic as it goes to the terminal, in a language.
    pub fn say(&self, lang: Lang) -> String {
        match self {
            RecordingError::File(e) => {
                format!("{}: {}\n", note!("diagnostic.error").say(lang), e.say(lang))
            }
            RecordingError::Manifest(problems) => problems.say(lang),
        }
    }
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.say(Lang::En).trim_end())
    }
}

impl std::error::Error for RecordingError {}

impl From<IngestError> for RecordingError {
    fn from(e: IngestError) -> Self {
        RecordingError::File(e)
    }
}

/// Opens what a user named: one file, several in sequence, patterns such as `unit7/*.csv`, or a manifest.
///
/// # Errors
/// [`RecordingError`].
pub fn open_recording(named: &[PathBuf], options: &ReadOptions) -> Result<Recording, RecordingError> {
    let none = Path::new("");
    let name = named.first().map_or(none, PathBuf::as_path);
    if named.len() == 1 && manifest::is_manifest(name) {
        let manifest = manifest::load(name).map_err(RecordingError::Manifest)?;
        let options = with_layout(&manifest.options_over(options))?;
        let source = multi_file::open(name, &manifest.parts(), manifest.contiguous, &options)?;
        let source = beside(source, &options.sources)?;
        return Ok(Recording { source, manifest: Some(manifest) });
    }
    let options = &with_layout(options)?;
    let mut files = Vec::new();
    for path in named {
        match pattern_of(path) {
            Some(pattern) => files.extend(expand(path, &pattern)?),
            None => files.push(path.clone()),
        }
    }
    if let [one] = files.as_slice() {
        return Ok(Recording { source: open_with(one, options)?, manifest: None });
    }
    if let Some(odd) = files.iter().find(|f| manifest::is_manifest(f)) {
        let error = IngestError::new(IngestErrorKind::Parts, odd, "ingest.joined.manifest_alone");
        return Err(error.hint("ingest.joined.hint.manifest_alone").into());
    }
    let specs: Vec<PartSpec> =
        files.iter().map(|f| PartSpec { path: f.clone(), ..PartSpec::default() }).collect();
    let source = beside(multi_file::open(name, &specs, false, options)?, &options.sources)?;
    Ok(Recording { source, manifest: None })
}

/// The options with their layout read, where there is one.
fn with_layout(options: &ReadOptions) -> Result<ReadOptions, IngestError> {
    let mut options = options.clone();
    if let Some(file) = options.layout.as_mut().filter(|f| f.layout.is_none()) {
        let read = layout::load(&file.path).map_err(|problems| refused(&file.path, &problems))?;
        file.layout = Some(Arc::new(read));
    }
    Ok(options)
}

/// Opens one file by options whose layout need not be read yet.
///
/// # Errors
/// [`IngestError`] of the layout or the file.
pub fn open_with(path: &Path, options: &ReadOptions) -> Result<Source, IngestError> {
    beside(sagnac_ingest::open_with(path, &with_layout(options)?)?, &options.sources)
}

/// Opens files of a manifest as one recording, each with the phase given for it.
///
/// # Errors
/// [`IngestError`] of one of them.
pub fn open_files(
    name: &Path,
    files: &[manifest::ManifestFile],
    contiguous: bool,
    options: &ReadOptions,
) -> Result<Source, IngestError> {
    let part = |f: &manifest::ManifestFile| PartSpec {
        path: f.path.clone(),
        sha256: f.sha256.clone(),
        phase: f.phase.clone(),
    };
    let options = &with_layout(options)?;
    match files {
        [one] if one.phase.is_none() => open_with(&one.path, options),
        _ => {
            let parts: Vec<PartSpec> = files.iter().map(part).collect();
            beside(multi_file::open(name, &parts, contiguous, options)?, &options.sources)
        }
    }
}

/// Every file that is read for what a user named: the files themselves, a manifest and what it lists, a layout. What
/// cannot be found out is left out: opening says why.
pub fn files_read(named: &[PathBuf], options: &ReadOptions) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut layout = options.layout.as_ref().map(|l| l.path.clone());
    for path in named {
        if !manifest::is_manifest(path) {
            files.extend(each_of(path).unwrap_or_else(|_| vec![path.clone()]));
            continue;
        }
        files.push(path.clone());
        if let Ok(manifest) = manifest::load(path) {
            files.extend(manifest.files.iter().map(|f| f.path.clone()));
            files.extend(manifest.options.sources.iter().flat_map(SecondSource::files).cloned());
            layout = manifest.options.layout.map(|l| l.path).or(layout);
        }
    }
    files.extend(options.sources.iter().flat_map(SecondSource::files).cloned());
    files.extend(layout);
    files
}

/// The files that a path names one by one: those of a pattern in their order, else the path itself.
///
/// # Errors
/// [`IngestError`] of a pattern that is wrong or names nothing.
pub fn each_of(path: &Path) -> Result<Vec<PathBuf>, IngestError> {
    match pattern_of(path) {
        Some(pattern) => expand(path, &pattern),
        None => Ok(vec![path.to_owned()]),
    }
}

/// True where what a user named may stand for several files: more than one name, or a pattern. A manifest stands for its
/// files and says how they belong together.
pub fn are_several(named: &[PathBuf]) -> bool {
    named.len() > 1 || named.first().is_some_and(|path| pattern_of(path).is_some())
}

/// The text of a path that is a pattern and no file.
fn pattern_of(path: &Path) -> Option<String> {
    let text = path.to_str()?;
    (text.contains(['*', '?', '[']) && !path.exists()).then(|| text.to_owned())
}

/// The files that a pattern names, part2 before part10.
fn expand(path: &Path, pattern: &str) -> Result<Vec<PathBuf>, IngestError> {
    let error = |note: Note| IngestError::new(IngestErrorKind::Io, path, note);
    let most = multi_file::MAX_FILES;
    let mut files = pattern::files(Path::new(""), pattern, most)
        .map_err(|e| error(e.note("ingest.joined.bad_pattern", "ingest.joined.wide_pattern")))?;
    if files.len() > most {
        let note = note!("ingest.joined.too_many", count = files.len(), most);
        return Err(error(note));
    }
    if files.is_empty() {
        return Err(error(note!("ingest.joined.no_match")).hint("ingest.joined.hint.quote_pattern"));
    }
    files.sort_by_cached_key(|f| pattern::natural(&f.to_string_lossy()));
    Ok(files)
}
