//! Noise models: coefficients, how well they fit, and the Allan family beside them.

use super::common::{MODEL_NOTES, probability};
use super::part::Part;
use super::{deviations, rows};
use crate::measurand;
use crate::noise::residual::View;
use crate::record::{GoodnessOfFitRecord, MeasurandRecord, NoiseModelRecord};
use crate::report::number::{NOTHING, digits, limit_digits};
use crate::report::page::{Block, Column, List, Table, Value};
use crate::report::translator::Translator;

/// The models with their remarks, the goodness of fit, and the Allan family by channel.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let (record, words) = (part.record, part.words);
    if record.noise_models.is_empty() {
        return vec![];
    }
    let models: Vec<Model<'_>> = record.noise_models.iter().map(|m| Model::new(m, part)).collect();
    let mut below = vec![Block::Hint(words.t("report.models_hint")), Block::Table(table(&models, part))];
    below.extend(models.iter().filter_map(|m| m.list(part.several_channels)));
    below.extend(goodness(part));
    below.extend(deviations::deviations(part));
    vec![Block::section("", words.t("report.models"), below)]
}

/// A noise model with what is to be said of it.
struct Model<'a> {
    /// The model.
    of: &'a NoiseModelRecord,
    /// What limits its use, and whether that is a misfit.
    remarks: Vec<(String, bool)>,
    /// Whether it describes the spectrum of the record, in words.
    fit: String,
}

impl<'a> Model<'a> {
    fn new(m: &'a NoiseModelRecord, part: &Part<'_>) -> Model<'a> {
        let words = part.words;
        let mut remarks: Vec<(String, bool)> = vec![];
        let rows = part.record.measurands.iter().filter(|r| r.channel == m.channel);
        for note in rows.flat_map(|r| &r.notes).filter(|n| MODEL_NOTES.contains(&n.id.as_ref())) {
            let remark = (words.say(note), note.id == "note.model_misfit");
            if !remarks.contains(&remark) {
                remarks.push(remark);
            }
        }
        remarks.extend(m.remarks.iter().map(|note| (words.say(note), false)));
        // One question, one probability: that of the view by frequency, where the record is long enough for one.
        let by_frequency = |g: &&GoodnessOfFitRecord| g.channel == m.channel && g.view == View::Frequency;
        let fit = part.record.goodness_of_fit.iter().find(by_frequency);
        let p = probability(fit.map_or(m.misfit_probability, |f| f.p_value), words);
        // The remark on the misfit names the band.
        let is_misfit_said = remarks.iter().any(|r| r.1);
        let departs = is_misfit_said || fit.map_or(m.misfit_band_hz.is_some(), |f| f.departs);
        if let Some([low, high]) = m.misfit_band_hz.filter(|_| !is_misfit_said) {
            let [low, high] = [low, high].map(|f| digits(f, 3, words.lang));
            let range = words.with("report.interval", &[("low", &low), ("high", &high)]);
            let band = words.quantity(&range, "Hz");
            remarks.insert(0, (words.with("report.misfit_band", &[("band", &band)]), false));
        }
        let key = if departs { "report.fit_departs" } else { "report.fit_good" };
        Model { of: m, remarks, fit: words.with(key, &[("p", &p)]) }
    }

    fn method(&self, words: Translator) -> Value {
        let terms: Vec<String> = self.of.terms.iter().map(|t| words.name("term", t.id())).collect();
        let terms = if terms.is_empty() { NOTHING.to_owned() } else { terms.join(", ") };
        let claimed = words.with("report.terms_claimed", &[("terms", &terms)]);
        Value::Text(words.name("how", &self.of.method)).over([Value::Text(claimed)])
    }

    /// The remarks, behind the channel where there are several.
    fn list(&self, several_channels: bool) -> Option<Block> {
        let said = |text: &String| {
            if several_channels { format!("{}: {text}", self.of.channel) } else { text.clone() }
        };
        let items: Vec<(String, bool)> = self.remarks.iter().map(|(text, m)| (said(text), *m)).collect();
        (!items.is_empty()).then_some(Block::List(List { class: "remarks", items }))
    }
}

fn table(models: &[Model<'_>], part: &Part<'_>) -> Table {
    let words = part.words;
    let mut table = Table::new("", models.len());
    if part.several_channels {
        table = table.column(words.column("report.channel"), models.iter().map(|m| m.of.channel.clone()));
    }
    table = table.column(words.column("report.method"), models.iter().map(|m| m.method(words)));
    for (symbol, term, of) in COEFFICIENTS {
        let cell = |m: &Model<'_>| {
            let rows = &part.record.measurands;
            coefficient(term, of(m.of), &m.of.channel, rows, words)
        };
        table = table.column(Column::number(*symbol, *symbol), models.iter().map(cell));
    }
    table.column(words.column("report.fit"), models.iter().map(|m| m.fit.clone()))
}

/// A coefficient of a model.
type Coefficient = (&'static str, &'static measurand::Measurand, fn(&NoiseModelRecord) -> f64);

/// Symbol, quantity and value of every coefficient.
const COEFFICIENTS: &[Coefficient] = &[
    ("N", &measurand::ANGLE_RANDOM_WALK, |m| m.angle_random_walk),
    ("B", &measurand::BIAS_INSTABILITY, |m| m.bias_instability),
    ("K", &measurand::RATE_RANDOM_WALK, |m| m.rate_random_walk),
    ("R", &measurand::RATE_RAMP, |m| m.rate_ramp),
    ("Q", &measurand::QUANTIZATION, |m| m.quantization),
];

/// Relative difference below which a row and the model speak of the same value.
const SAME_VALUE: f64 = 5e-3;

/// The value of a coefficient with its unit, below it the interval where the record shows the term.
fn coefficient(
    term: &measurand::Measurand,
    value: f64,
    channel: &str,
    measurands: &[MeasurandRecord],
    words: Translator,
) -> Value {
    let (id, unit) = (term.id, term.unit);
    // Its row has the interval, when it speaks of the same value: the fit that is drawn was polished once more.
    let row = measurands.iter().find(|r| {
        r.id == id
            && r.channel == channel
            && r.unit == unit
            && value != 0.0
            && r.value.is_some_and(|v| (v - value).abs() < SAME_VALUE * value.abs())
    });
    match row {
        Some(row) => {
            let shown = words.quantity(&rows::value(row, words), unit);
            Value::Text(shown).over([Value::Text(rows::interval(row, words))])
        }
        None if value == 0.0 => NOTHING.into(),
        None => words.quantity(&limit_digits(value, 4, words.lang), unit).into(),
    }
}

/// How well the models fit, view by view.
fn goodness(part: &Part<'_>) -> Vec<Block> {
    let (all, words) = (&part.record.goodness_of_fit, part.words);
    if all.is_empty() {
        return vec![];
    }
    let finding = |g: &GoodnessOfFitRecord| {
        let said = words.say(&g.message);
        let said = Value::Sentence(said);
        if g.departs { said.strong() } else { said }
    };
    let mut table = Table::new("", all.len());
    if part.several_channels {
        table = table.column(words.column("report.channel"), all.iter().map(|g| g.channel.clone()));
    }
    table = table
        .column(
            words.column("goodness.seen_by"),
            all.iter().map(|g| words.t(&format!("goodness.view.{}", g.view.id()))),
        )
        .column(
            words.number_column("goodness.probability"),
            all.iter().map(|g| probability(g.p_value, words)),
        )
        .column(words.column("goodness.finding"), all.iter().map(finding));
    vec![Block::subheading(words.t("goodness.title")), Block::Table(table)]
}
