//! The recording against the model of its family, printed.

use crate::i18n::Lang;
use crate::record::ExplainedRecord;
use crate::report::explain::explained_summary;
use serde::Serialize;

/// The recording against the model of its family.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explained {
    /// The model.
    pub model: String,
    /// What came of it, in sentences.
    pub summary: Vec<String>,
    /// The whole explanation, where there is one.
    pub page: Option<&'static str>,
}

impl Explained {
    /// Of what the record holds.
    pub fn new(explained: &ExplainedRecord, lang: Lang) -> Explained {
        Explained {
            model: explained.model.clone(),
            summary: explained_summary(explained, lang),
            page: explained.explanation.as_ref().map(|_| "explain/report.html"),
        }
    }
}
