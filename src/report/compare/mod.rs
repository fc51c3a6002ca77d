//! The view of a comparison: words and printed numbers, ready for a template and for the terminal.

mod published;
mod terminal;
mod unit;

pub use published::PublishedView;
pub use terminal::table;
pub use unit::{Cell, LimitView, RuleCell, ShareView, UnitView};

use super::document::{Contents, Documented, Record};
use super::number::date_time;
use super::translator::Translator;
use super::view::FigureView;
use crate::acceptance::compare::Comparison;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use serde::Serialize;

/// Everything that a comparison shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompareView {
    /// The units.
    pub units: Vec<UnitView>,
    /// Limits with the figure each names.
    pub limits: Vec<LimitView>,
    /// σ(τ) of the units on common axes, where several have it.
    pub sigma_tau: Option<FigureView>,
    /// The figure of the ratios, where there is one.
    pub ratios: Option<FigureView>,
    /// The published tables.
    pub published: Option<PublishedView>,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

impl Documented for Comparison {
    fn record(&self) -> Record<'_> {
        Record::Comparison(self)
    }

    fn kind(&self) -> Kind {
        Kind::Comparison
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn made_at(&self) -> &str {
        &self.compared_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn contents(&self, figures: &[Figure], lang: Lang) -> Contents {
        Contents::view("compare", &CompareView::new(self, figures, lang), lang)
    }
}

impl CompareView {
    /// Builds the view.
    pub fn new(comparison: &Comparison, figures: &[Figure], lang: Lang) -> CompareView {
        let words = Translator { lang };
        let drawn = |id: &str| {
            let at = figures.iter().position(|f| f.id == id)?;
            figures.get(at).map(|f| FigureView::of(f, at + 1, words))
        };
        let generator = format!("{} {}", comparison.program.name, comparison.program.version);
        CompareView {
            units: comparison
                .units
                .iter()
                .enumerate()
                .map(|(i, u)| UnitView::new(u, drawn(&format!("octaves_{}", i + 1)), words))
                .collect(),
            limits: comparison.units.iter().flat_map(|u| unit::limits(u, words)).collect(),
            sigma_tau: drawn("sigma_tau"),
            ratios: drawn("ratios"),
            published: comparison.published.as_ref().map(|p| PublishedView::new(p, words)),
            footer: format!("{} · {generator}", date_time(&comparison.compared_at)),
            generator,
        }
    }
}
