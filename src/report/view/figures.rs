//! Figures as a report shows them.

use crate::figure::{Figure, Layer};
use crate::i18n::lookup;
use crate::record::RunRecord;
use crate::report::translator::Translator;
use crate::report::{file_name, svg};

pub use crate::report::page::Figure as FigureView;

impl FigureView {
    /// Draws a figure; `file` is that of the drawing, relative to the report.
    pub(crate) fn new(figure: &Figure, number: usize, file: &str, words: Translator) -> FigureView {
        let title = words.t(&figure.title);
        FigureView {
            id: figure.id.clone(),
            number,
            mark: String::new(),
            title: if figure.channel.is_empty() { title } else { format!("{title} · {}", figure.channel) },
            caption: caption(figure, words),
            is_titled: false,
            svg: svg::render(figure, words.lang),
            readings: svg::readings(figure, words.lang),
            href: encode(file),
        }
    }

    /// The same with the usual name of the file.
    pub(crate) fn of(figure: &Figure, number: usize, words: Translator) -> FigureView {
        FigureView::new(figure, number, &format!("figures/{}", file_name(&figure.id)), words)
    }

    /// The figure of an id, numbered by its place.
    pub(crate) fn find(figures: &[Figure], id: &str, words: Translator) -> Option<FigureView> {
        let place = figures.iter().position(|f| f.id == id)?;
        figures.get(place).map(|f| FigureView::of(f, place + 1, words))
    }
}

/// The figures of a report with their titles and captions.
pub(super) fn select(record: &RunRecord, figures: &[Figure], words: Translator) -> Vec<FigureView> {
    let view = |(i, figure): (usize, &Figure)| match record.figures.iter().find(|f| f.id == figure.id) {
        Some(known) => FigureView::new(figure, i + 1, &known.file, words),
        None => FigureView::of(figure, i + 1, words),
    };
    figures.iter().enumerate().map(view).collect()
}

/// What is to be seen, in a sentence, and the numbers that belong to it.
fn caption(figure: &Figure, words: Translator) -> String {
    let id = figure.title.strip_prefix("figure.title.").unwrap_or_default();
    let mut sentences: Vec<String> =
        lookup(words.lang, &format!("figure.caption.{id}")).map(str::to_owned).into_iter().collect();
    let mut layers = figure.panels.iter().flat_map(|p| &p.layers);
    if id == "time_series" && layers.any(|l| matches!(l, Layer::Span { .. })) {
        sentences.push(words.t("figure.caption.shaded"));
    }
    sentences.extend(figure.remarks.iter().map(|r| words.say(r)));
    sentences.join(" ")
}

/// A relative path as a URL.
fn encode(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    for byte in path.replace('\\', "/").bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'/' | b'.' | b'-' | b'_' | b'~' | b'@') {
            out.push(char::from(byte));
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
    out
}
