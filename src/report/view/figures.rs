//! Figures as a report shows them.

use super::part::Part;
use crate::figure::{Figure, Layer};
use crate::i18n::lookup;
use crate::report::page::Block;
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

/// The figure that shows most of a test, for its first page; nothing where the data of figures are not kept.
pub(super) fn key(part: &Part<'_>) -> Option<Block> {
    let first = ordered(part).into_iter().next()?;
    Some(Block::Section("figures key", vec![numbered(first, 1, part)]))
}

/// The figures without the key figure, or that their data are not kept.
pub(super) fn others(part: &Part<'_>) -> Vec<Block> {
    from(2, part)
}

/// The figures, or that their data are not kept.
pub(super) fn all(part: &Part<'_>) -> Vec<Block> {
    from(1, part)
}

/// The figures from a number on.
fn from(first: usize, part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let figures = (1..).zip(ordered(part)).skip_while(|(number, _)| *number < first);
    let mut below: Vec<Block> = figures.map(|(number, figure)| numbered(figure, number, part)).collect();
    if part.figures.is_empty() && !part.figure_records.is_empty() {
        below.push(Block::Paragraph(words.t("report.figures_missing")));
    }
    if below.is_empty() {
        return vec![];
    }
    vec![Block::section("figures", words.t("report.figures"), below)]
}

/// The figures, the key figure first: σ(τ) where there is one, otherwise the first that is not the record itself.
fn ordered<'a>(part: &Part<'a>) -> Vec<&'a Figure> {
    let rank = |figure: &&Figure| match figure.id.as_str() {
        id if id.starts_with("sigma_tau") => 0,
        id if id.starts_with("time_series") => 2,
        _ => 1,
    };
    let key =
        (0..).zip(part.figures).min_by_key(|(_, figure)| rank(figure)).map_or(0, |(at, _): (usize, _)| at);
    let mut figures: Vec<&Figure> = part.figures.iter().collect();
    if let Some(first) = figures.get_mut(..=key) {
        first.rotate_right(1);
    }
    figures
}

/// A figure with its number before its caption.
fn numbered(figure: &Figure, number: usize, part: &Part<'_>) -> Block {
    let words = part.words;
    let drawn = match part.figure_records.iter().find(|f| f.id == figure.id) {
        Some(known) => FigureView::new(figure, number, &known.file, words),
        None => FigureView::of(figure, number, words),
    };
    let label = words.with("report.figure_number", &[("number", &number.to_string())]);
    let text = if drawn.caption.is_empty() { &drawn.title } else { &drawn.caption };
    let caption = format!("{label}. {text}");
    Block::Figure(Box::new(FigureView { mark: format!("figure-{}{number}", part.anchor), caption, ..drawn }))
}

/// What is to be seen, in a sentence, and the numbers that belong to it.
pub(in crate::report) fn caption(figure: &Figure, words: Translator) -> String {
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
