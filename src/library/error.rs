//! The one error of the library.

use crate::acceptance::RunError;
use crate::config::diagnostics::{Problem, Problems};
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{IngestError, RecordingError};
use crate::report::ReportError;
use crate::series::SeriesError;
use std::fmt;

/// Why a call of the library gave no result.
///
/// [`fmt::Display`] is one or more sentences in English; [`Error::localized`] gives them in another language. The
/// predicates tell what the error is about, and [`std::error::Error::source`] has the error of the operating system where
/// there is one.
#[derive(Debug)]
pub struct Error(Box<Kind>);

#[derive(Debug)]
enum Kind {
    Recording(SeriesError),
    Configuration(Problems),
    Run(RunError),
    Report(ReportError),
    Argument(Note),
}

impl Error {
    /// An argument that cannot be used, or that does not fit the recording.
    pub(super) fn argument(note: impl Into<Note>) -> Error {
        Error(Box::new(Kind::Argument(note.into())))
    }

    /// The error in a language, without a line break at the end.
    pub fn localized(&self, lang: Lang) -> String {
        let text = match self.0.as_ref() {
            Kind::Recording(SeriesError::Open(RecordingError::Manifest(problems))) => problems.say(lang),
            Kind::Recording(e) => e.note().say(lang),
            Kind::Configuration(problems) => problems.say(lang),
            Kind::Run(e) => e.note().say(lang),
            Kind::Report(e) => e.note().say(lang),
            Kind::Argument(note) => note.say(lang),
        };
        text.trim_end().to_owned()
    }

    /// The problems of the files that are wrong, each with file, line and column; empty for other errors.
    pub fn problems(&self) -> &[Problem] {
        match self.0.as_ref() {
            Kind::Configuration(problems)
            | Kind::Recording(SeriesError::Open(RecordingError::Manifest(problems))) => &problems.list,
            _ => &[],
        }
    }

    /// An error that a note tells: an argument that cannot be used.
    pub fn of_note(note: Note) -> Error {
        Error::argument(note)
    }

    /// The problem of a recording and its place, when that is what the error is about.
    pub fn ingest(&self) -> Option<&IngestError> {
        match self.0.as_ref() {
            Kind::Recording(SeriesError::Open(RecordingError::File(e)) | SeriesError::Read(e))
            | Kind::Run(RunError::Ingest(e)) => Some(e),
            _ => None,
        }
    }

    /// True when a recording could not be opened or read.
    pub fn is_recording(&self) -> bool {
        matches!(self.0.as_ref(), Kind::Recording(_) | Kind::Run(RunError::Ingest(_)))
    }

    /// True when a procedure, a limits file or a model is wrong; the text lists every problem with its line and column.
    pub fn is_configuration(&self) -> bool {
        matches!(self.0.as_ref(), Kind::Configuration(_))
    }

    /// True when the recording was read and holds too little to evaluate.
    pub fn is_not_evaluable(&self) -> bool {
        matches!(self.0.as_ref(), Kind::Run(RunError::TauGrid(_) | RunError::Nothing(_)))
    }

    /// True when an argument cannot be used: an unknown column, a unit that is not an angular rate, and the like.
    pub fn is_argument(&self) -> bool {
        matches!(self.0.as_ref(), Kind::Argument(_))
    }

    /// True when a result could not be rendered or written.
    pub fn is_output(&self) -> bool {
        matches!(self.0.as_ref(), Kind::Report(_))
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.localized(Lang::En))
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self.0.as_ref() {
            Kind::Report(e) => e.source(),
            _ => None,
        }
    }
}

impl From<SeriesError> for Error {
    fn from(e: SeriesError) -> Error {
        match e {
            SeriesError::Unclear(note) => Error::argument(note),
            other => Error(Box::new(Kind::Recording(other))),
        }
    }
}

impl From<RecordingError> for Error {
    fn from(e: RecordingError) -> Error {
        SeriesError::Open(e).into()
    }
}

impl From<IngestError> for Error {
    fn from(e: IngestError) -> Error {
        SeriesError::Read(e).into()
    }
}

impl From<Problems> for Error {
    fn from(problems: Problems) -> Error {
        Error(Box::new(Kind::Configuration(problems)))
    }
}

impl From<RunError> for Error {
    fn from(e: RunError) -> Error {
        Error(Box::new(Kind::Run(e)))
    }
}

impl From<ReportError> for Error {
    fn from(e: ReportError) -> Error {
        Error(Box::new(Kind::Report(e)))
    }
}
