//! Rows of quantities by a formula, from the estimates of the other rows.

use super::verdict::{Against, judged};
use crate::config::procedure::derived::DerivedSpec;
use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::estimate::{Component, Estimate, InputQuantity, LowerLimit, Spread, UpperLimit};
use crate::formula::{Channels, Input, Outcome, Reference};
use crate::i18n::note;
use crate::measurand;
use crate::record::MeasurandRecord;
use crate::units::Unit;

/// Method of these rows.
const METHOD: &str = "formula";

/// Correlation of two estimates from one fit; `None` where it is not known.
pub(super) type Correlation<'a> = &'a dyn Fn(&Estimate, &Estimate) -> Option<f64>;

/// A value that a formula may name: a row that was measured, or an earlier formula.
struct Known<'e> {
    id: String,
    channel: String,
    input: Input,
    estimate: Option<&'e Estimate>,
}

/// The rows of all formulas of a procedure, for the gyro channels that were read.
pub(super) fn rows(
    procedure: &Procedure,
    limits: &EffectiveLimits,
    channels: &[&str],
    estimates: &[Estimate],
    correlation: Correlation<'_>,
) -> Vec<MeasurandRecord> {
    let mut known: Vec<Known<'_>> = estimates.iter().filter_map(Known::measured).collect();
    let mut rows = vec![];
    for spec in &procedure.derived {
        let whole = channels.join("+");
        let own: Vec<&str> =
            if is_of_every_channel(spec, procedure) { channels.to_vec() } else { vec![whole.as_str()] };
        for channel in own {
            let (outcome, row) = evaluated(spec, channel, channels, &known, limits, correlation);
            known.push(Known {
                id: spec.id.clone(),
                channel: channel.to_owned(),
                input: as_input(&outcome),
                estimate: None,
            });
            rows.push(row);
        }
    }
    rows
}

/// True where a formula, or one that it names, names a quantity without a channel.
fn is_of_every_channel(spec: &DerivedSpec, procedure: &Procedure) -> bool {
    spec.formula.references.iter().any(|(reference, _)| {
        let other = procedure.derived.iter().take_while(|d| d.id != spec.id).find(|d| d.id == reference.id);
        reference.of == Channels::Own && other.is_none_or(|d| is_of_every_channel(d, procedure))
    })
}

impl<'e> Known<'e> {
    fn measured(estimate: &'e Estimate) -> Option<Known<'e>> {
        let factor = Unit::parse(estimate.unit).ok()?.base_factor();
        let signed = measurand::find(estimate.id).is_none_or(|m| m.signed);
        Some(Known {
            id: estimate.id.to_owned(),
            channel: estimate.channel.clone(),
            input: Input::of(estimate, signed, factor),
            estimate: Some(estimate),
        })
    }
}

/// An outcome as the input of a later formula, in base units.
fn as_input(outcome: &Outcome) -> Input {
    Input {
        value: outcome.value,
        spread: outcome.spread.clone(),
        common: outcome.common,
        upper_limit: outcome.upper_limit,
        lower_limit: outcome.lower_limit,
        ..Input::unknown(true, 1.0)
    }
}

/// One formula on one channel.
fn evaluated(
    spec: &DerivedSpec,
    channel: &str,
    channels: &[&str],
    known: &[Known<'_>],
    limits: &EffectiveLimits,
    correlation: Correlation<'_>,
) -> (Outcome, MeasurandRecord) {
    let found: Vec<Vec<Option<&Known<'_>>>> =
        spec.formula.references.iter().map(|(r, _)| named(r, channel, channels, known)).collect();
    let inputs: Vec<Vec<Input>> = found
        .iter()
        .map(|axes| {
            axes.iter().map(|k| k.map_or_else(|| Input::unknown(true, 1.0), |k| k.input.clone())).collect()
        })
        .collect();
    let at = |(place, axis): (usize, usize)| found.get(place)?.get(axis)?.as_ref()?.estimate;
    let correlations = |a, b| if a == b { Some(1.0) } else { correlation(at(a)?, at(b)?) };
    let outcome = spec.formula.evaluate(&inputs, &correlations);

    let mut notes = vec![note!("derived.formula", formula = spec.formula.text.as_str())];
    let of_reference = |(i, (r, _)): (usize, &(Reference, _))| {
        let shown = inputs.get(i).is_some_and(|axes| axes.iter().all(|a| a.value.is_some()));
        (!shown).then(|| r.id.clone())
    };
    let unresolved: Vec<String> =
        spec.formula.references.iter().enumerate().filter_map(of_reference).collect();
    if !unresolved.is_empty() {
        notes.push(note!("derived.unresolved", names = unresolved.join(", ")));
    }
    if outcome.value.is_some() && inputs.iter().map(Vec::len).sum::<usize>() > 1 {
        notes.push(note!("derived.correlation"));
    }
    let estimate = Estimate { notes, ..in_unit(&outcome, &spec.unit, channel) };
    (outcome, own_row(&estimate, &spec.id, &spec.unit, limits))
}

/// The values that a reference names, one or several; `None` for one that is not there.
fn named<'k, 'e>(
    reference: &Reference,
    channel: &str,
    channels: &[&str],
    known: &'k [Known<'e>],
) -> Vec<Option<&'k Known<'e>>> {
    let of = |channel: &str| {
        let whole = |k: &&Known<'_>| k.id == reference.id && k.channel == channel;
        let any = || known.iter().find(|k| k.id == reference.id && k.channel.contains('+'));
        known.iter().find(whole).or_else(any)
    };
    match &reference.of {
        Channels::Own => vec![of(channel)],
        Channels::Named(named) => vec![of(named)],
        Channels::Worst => channels.iter().map(|c| of(c)).collect(),
    }
}

/// An outcome in a unit.
fn in_unit(outcome: &Outcome, unit: &Unit, channel: &str) -> Estimate {
    let factor = 1.0 / unit.base_factor();
    let spread = match &outcome.spread {
        Spread::Curve(points) => Spread::Curve(points.iter().map(|(z, v)| (*z, v * factor)).collect()),
        _ => Spread::Unknown,
    };
    let estimate = match outcome.value {
        Some(value) => Estimate::measured("", channel, value * factor, "", spread, METHOD),
        None => Estimate::not_identifiable("", channel, None, "", METHOD),
    };
    let shared = (outcome.common > 0.0)
        .then(|| Component::of(InputQuantity::FormulaInputs, outcome.common * factor, unit.text(), 1.0));
    Estimate {
        components: shared.into_iter().collect(),
        upper_limit: outcome.upper_limit.map(|l| UpperLimit { value: l.value * factor, ..l }),
        lower_limit: outcome.lower_limit.map(|l| LowerLimit { value: l.value * factor, ..l }),
        ..estimate
    }
}

/// The row of a quantity that is no measurand, judged by the limit that holds for it.
pub(super) fn own_row(
    estimate: &Estimate,
    id: &str,
    unit: &Unit,
    limits: &EffectiveLimits,
) -> MeasurandRecord {
    let stated = limits.set.derived.iter().find(|l| l.derived == id);
    let limit = stated.map(|l| l.in_unit(unit));
    // A limit in a unit that does not fit decides nothing, as with every row.
    let other_unit = limit.as_ref().and_then(|l| l.as_ref().err()).map(|(bound, _)| bound.unit.text());
    let as_stated = stated.and_then(|l| {
        let bound = l.max.as_ref().or(l.min.as_ref())?;
        l.in_unit(&bound.unit).ok()
    });
    let limit = limit.and_then(Result::ok).or(as_stated.filter(|_| other_unit.is_some()));
    let against =
        Against { limit: limit.as_ref(), unit: unit.text(), other_unit, signed: true, reference: None };
    MeasurandRecord { id: id.to_owned(), ..judged(estimate, against) }
}
