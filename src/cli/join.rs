//! Several files as one recording: only where that is asked for.

use super::place;
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::{RecordingError, are_several, each_of};
use clap::Args;
use std::path::PathBuf;

/// Whether several files are one recording.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct JoinArgs {
    /// Read several files, or all that match a pattern, in sequence as one recording
    #[arg(long)]
    pub join: bool,
}

impl JoinArgs {
    /// Refuses several files where nobody said what they are. `help` names the choices of the verb.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn check(self, named: &[PathBuf], help: &'static str, lang: Lang) -> Result<(), String> {
        if self.join || !are_several(named) {
            return Ok(());
        }
        let mut files = 0;
        for path in named {
            files += each_of(path).map_err(|e| RecordingError::from(e).say(lang))?.len();
        }
        let first = named.first().map(|p| p.display().to_string()).unwrap_or_default();
        let key = if named.len() > 1 { "join.several" } else { "join.pattern" };
        let note = Note::new(key).with("n", files).with("first", first);
        let help = Note::new(help).say(lang);
        Err(format!("{}  {}: {help}\n", place::error(&note, lang), note!("diagnostic.help").say(lang)))
    }
}
