//! Figures for papers: those of a report with few layers, of several records in one, at the width of a column.

mod format;
mod layers;
mod overlay;
mod unit;

pub use format::{FORMATS, Format};
pub use layers::{LAYERS, LayerKind};
pub use overlay::{MAX_SOURCES, Source, overlay};
pub use unit::in_unit;

use super::results::{ExplanationResults, Results};
use super::translator::Translator;
use super::view;
use crate::figure::Figure;
use crate::i18n::{Lang, Note, note};

/// Name of a figure: the last part of the key of its title. A figure over the same axes has the same name in every record.
pub fn name(figure: &Figure) -> &str {
    let mut parts = figure.title.rsplit('.');
    match (parts.next(), parts.next()) {
        (Some("title"), Some(of)) => of,
        (Some(last), _) => last.strip_prefix("title_").unwrap_or(last),
        _ => "",
    }
}

/// The figures of results, those of explanations behind those of the whole.
pub fn figures(results: &Results, lang: Lang) -> Vec<Figure> {
    let explained: Vec<&ExplanationResults> = match results {
        Results::Run(run) => run.explanation.iter().collect(),
        Results::Joint(joint) => joint.recordings.iter().flatten().collect(),
        Results::Explanation(_) | Results::Other(_) => vec![],
    };
    let explained = explained.into_iter().flat_map(|e| e.figures.iter().cloned());
    results.whole(lang).figures.iter().cloned().chain(explained).collect()
}

/// The words below a figure: its title, what is to be seen, and the numbers that belong to it.
pub fn caption(figure: &Figure, lang: Lang) -> String {
    let words = Translator { lang };
    let sentences = view::caption(figure, words);
    let title = words.t(&figure.title);
    if sentences.is_empty() { format!("{title}.") } else { format!("{title}. {sentences}") }
}

/// The layers of a figure that are chosen.
///
/// # Errors
/// A note where the figure has none of them.
pub fn with_layers(figure: &mut Figure, chosen: &[LayerKind]) -> Result<(), Note> {
    let layers = figure.panels.iter().flat_map(|p| &p.layers);
    let mut there: Vec<&str> = layers.map(|l| LayerKind::of(l).id()).collect();
    there.sort_unstable();
    there.dedup();
    layers::keep(figure, chosen);
    if figure.panels.iter().all(|p| p.layers.is_empty()) {
        return Err(note!("figure_paper.no_layers", known = there.join(", ")));
    }
    Ok(())
}
