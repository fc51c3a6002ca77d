//! The view of a data sheet: words and printed numbers, ready for a template and for the terminal.

mod quantity;

pub use quantity::{BoundView, QuantityView};

use super::document::{Contents, Documented, Record};
use super::number::{count, date_time, duration, limit_digits};
use super::translator::{Field, Translator};
use super::view::FigureView;
use crate::acceptance::datasheet::figures::figure_id;
use crate::figure::Figure;
use crate::i18n::{Lang, Localize};
use crate::output::Kind;
use crate::record::{DataSheet, SheetCondition, SheetPair};
use serde::Serialize;

/// Everything that a data sheet shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SheetView {
    /// Model, or the procedure where none is named.
    pub title: String,
    /// Units and lots, in words.
    pub size: String,
    /// What the bounds promise, in a sentence.
    pub promise: String,
    /// Procedure, program.
    pub identity: Vec<Field>,
    /// Conditions of the tests.
    pub conditions: Vec<Field>,
    /// What must be known of the whole.
    pub notes: Vec<String>,
    /// The quantities.
    pub quantities: Vec<QuantityView>,
    /// Russian beside Allan values.
    pub pairs: Vec<PairView>,
    /// σ(τ) of the channels.
    pub curves: Vec<FigureView>,
    /// Where every value comes from.
    pub results: Vec<ResultView>,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

/// A Russian value beside an Allan one, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairView {
    /// Channel; empty where there is one only.
    pub channel: String,
    /// Name of the Russian value.
    pub russian: String,
    /// Its median with unit.
    pub russian_value: String,
    /// Name of the Allan value.
    pub allan: String,
    /// Its median with unit.
    pub allan_value: String,
    /// Median ratio of single units.
    pub ratio: String,
    /// Smallest to largest ratio.
    pub range: String,
    /// Units that have both.
    pub units: String,
}

/// A result that counts, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResultView {
    /// Serial number.
    pub serial: String,
    /// Lot.
    pub lot: String,
    /// Id of the verdict, for colours.
    pub verdict: &'static str,
    /// The verdict in words.
    pub verdict_word: String,
    /// File as named.
    pub path: String,
    /// Its digest.
    pub sha256: String,
}

impl Documented for DataSheet {
    fn record(&self) -> Record<'_> {
        Record::DataSheet(self)
    }

    fn kind(&self) -> Kind {
        Kind::DataSheet
    }

    fn subject(&self) -> Option<&str> {
        self.model.as_deref()
    }

    fn made_at(&self) -> &str {
        &self.made_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn contents(&self, figures: &[Figure], lang: Lang) -> Contents {
        Contents::view("datasheet", &SheetView::new(self, figures, lang), lang)
    }
}

impl SheetView {
    /// Builds the view.
    pub fn new(sheet: &DataSheet, figures: &[Figure], lang: Lang) -> SheetView {
        let words = Translator { lang };
        let drawn = |id: &str| {
            let at = figures.iter().position(|f| f.id == id)?;
            figures.get(at).map(|f| FigureView::of(f, at + 1, words))
        };
        let several =
            sheet.quantities.iter().any(|q| Some(&q.channel) != sheet.quantities.first().map(|f| &f.channel));
        let generator = format!("{} {}", sheet.program.name, sheet.program.version);
        let quantities = sheet.quantities.iter().enumerate();
        SheetView {
            title: match (&sheet.title, &sheet.model) {
                (Some(title), _) => words.local(title),
                (None, Some(model)) => model.clone(),
                (None, None) => sheet.procedure.id.clone(),
            },
            size: words.with(
                "datasheet.size",
                &[("units", &count(sheet.units as u64, lang)), ("lots", &count(sheet.lots as u64, lang))],
            ),
            promise: promise(sheet, words),
            identity: identity(sheet, words, &generator),
            conditions: sheet.conditions.iter().map(|c| condition(c, words)).collect(),
            notes: sheet.notes.iter().map(|n| n.say(lang)).collect(),
            quantities: quantities
                .map(|(i, q)| QuantityView::new(q, several, drawn(&figure_id(i)), words))
                .collect(),
            pairs: sheet.pairs.iter().map(|p| pair(p, several, words)).collect(),
            curves: sheet
                .curves
                .iter()
                .map(|c| format!("sigma_tau_{}", c.channel))
                .chain(sheet.temperature_curves.iter().map(|c| format!("over_temperature_{}", c.channel)))
                .filter_map(|id| drawn(&id))
                .collect(),
            results: sheet
                .results
                .iter()
                .map(|r| ResultView {
                    serial: r.serial.clone(),
                    lot: r.lot.clone().unwrap_or_default(),
                    verdict: r.verdict.id(),
                    verdict_word: words.verdict(r.verdict),
                    path: r.path.clone(),
                    sha256: r.sha256.clone(),
                })
                .collect(),
            footer: format!("{} · {generator}", date_time(&sheet.made_at)),
            generator,
        }
    }
}

/// What the bounds promise; empty where there is none.
fn promise(sheet: &DataSheet, words: Translator) -> String {
    let Some(bound) = sheet.quantities.iter().find_map(|q| q.bounds.first()) else { return String::new() };
    let percent = |p: f64| limit_digits(100.0 * p, 4, words.lang);
    words.with(
        "datasheet.promise",
        &[("proportion", &percent(bound.proportion)), ("confidence", &percent(bound.confidence))],
    )
}

fn identity(sheet: &DataSheet, words: Translator, generator: &str) -> Vec<Field> {
    let p = &sheet.procedure;
    let mut fields = vec![];
    let mut put = |key: &str, value: String| fields.push(Field { label: words.t(key), value });
    if !p.id.is_empty() {
        put(
            "report.procedure",
            words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)]),
        );
    }
    put("datasheet.made_at", date_time(&sheet.made_at));
    put("report.program", generator.to_owned());
    fields
}

fn condition(c: &SheetCondition, words: Translator) -> Field {
    let printed = |v: f64| match c.id.as_str() {
        "temperature_degC" => words.quantity(&limit_digits(v, 4, words.lang), "degC"),
        "sample_rate_hz" => words.quantity(&limit_digits(v, 4, words.lang), "Hz"),
        _ => duration(v, words.lang),
    };
    let (from, to) = (printed(c.from), printed(c.to));
    let span = if from == to { from } else { words.with("datasheet.span", &[("from", &from), ("to", &to)]) };
    Field { label: words.name("datasheet.condition", &c.id), value: span }
}

fn pair(p: &SheetPair, several: bool, words: Translator) -> PairView {
    let digits = |v: f64| limit_digits(v, 3, words.lang);
    let value = |v: f64| words.quantity(&digits(v), &p.unit);
    let [low, high] = p.range;
    PairView {
        channel: if several { p.channel.clone() } else { String::new() },
        russian: words.name("measurand", &p.russian),
        russian_value: value(p.russian_value),
        allan: words.name("measurand", &p.allan),
        allan_value: value(p.allan_value),
        ratio: digits(p.ratio),
        range: words.with("report.interval", &[("low", &digits(low)), ("high", &digits(high))]),
        units: count(p.units as u64, words.lang),
    }
}
