//! What an influence changes the bias by: per unit of the influence, and at every level.

use super::descriptor::Measurand;
use super::evidence::ComparisonEvidence;
use crate::estimate::Estimate;
use crate::influence::Influence;
use crate::influence::comparison::Comparison;
use crate::message::{Arg, Note};
use crate::numeric::reml::Combination;
use crate::rate_table::combine::spread;

/// Bias per magnetic field.
pub static MAGNETIC_SENSITIVITY: Measurand = Measurand::of_influence(
    "magnetic_sensitivity",
    "deg/h/mT",
    "bias per magnetic field",
    Some(Influence::MagneticField),
    sensitivity,
)
.signed();

/// Bias per supply voltage.
pub static SUPPLY_SENSITIVITY: Measurand = Measurand::of_influence(
    "supply_sensitivity",
    "deg/h/V",
    "bias per supply voltage",
    Some(Influence::Supply),
    sensitivity,
)
.signed();

/// Bias per vibration power.
pub static VIBRATION_SENSITIVITY: Measurand = Measurand::of_influence(
    "vibration_sensitivity",
    "deg/h/g^2",
    "bias per vibration power",
    Some(Influence::Vibration),
    sensitivity,
)
.signed();

/// Change of the bias at every level.
pub static BIAS_SHIFT: Measurand = Measurand::of_influence(
    "bias_shift",
    "deg/h",
    "change of the bias at one level of an influence",
    None,
    shift,
)
.signed();

const METHOD: &str = "alternating_intervals";

/// One row an axis.
fn sensitivity(m: &Measurand, compared: &ComparisonEvidence<'_>) -> Vec<Estimate> {
    let found = compared.bias;
    let u = found.test.level_uncertainty * found.test.influence.degree();
    let rows = found.axes.iter().zip(&found.per_unit).enumerate().map(|(at, (axis, c))| {
        let degrees = found.temperature.as_ref().and_then(|t| t.per_drive.get(at));
        row(m, found, &found.place(axis, None), c, &[u * c.value.abs(), of_temperature(found, degrees)])
    });
    rows.collect()
}

/// One row a level.
fn shift(m: &Measurand, compared: &ComparisonEvidence<'_>) -> Vec<Estimate> {
    let found = compared.bias;
    let rows = found.shifts.iter().enumerate().map(|(at, s)| {
        let degrees = found.temperature.as_ref().and_then(|t| t.shifts.get(at));
        row(m, found, &found.place(&s.axis, Some(s.level)), &s.change, &[of_temperature(found, degrees)])
    });
    rows.collect()
}

/// What a difference of temperature may do to the bias is at most this: the standard uncertainty of a uniform law.
fn of_temperature(found: &Comparison, degrees: Option<&f64>) -> f64 {
    let coefficient = found.test.temperature_coefficient.unwrap_or(0.0);
    coefficient * degrees.map_or(0.0, |d| d.abs()) / 3f64.sqrt()
}

fn row(m: &Measurand, found: &Comparison, place: &str, c: &Combination, others: &[f64]) -> Estimate {
    let row = if found.confounded() {
        m.not_identifiable(place, None, METHOD)
    } else {
        m.measured(place, c.value, spread(c, 1.0, others), METHOD)
    };
    remarks(found).into_iter().fold(row, Estimate::note)
}

/// What a reader must know of the intervals.
fn remarks(found: &Comparison) -> Vec<Note> {
    let with = found.intervals.iter().filter(|i| !i.off).count();
    let key = if found.drift { "compared.intervals" } else { "compared.intervals_no_drift" };
    let without = found.intervals.len() - with;
    let mut notes = vec![Note::new(key).with("without", without).with("with", with)];
    if found.scatter {
        notes.push(Note::new("compared.scatter"));
    }
    if let Some(d) = found.too_warm() {
        notes.push(Note::new("compared.warmer").with("difference", Arg::figures(d.abs(), 2)));
    } else if let Some(t) = found.temperature.as_ref().filter(|t| t.follows()) {
        let difference = Arg::figures(t.difference().abs(), 2);
        notes.push(match found.test.temperature_coefficient {
            Some(c) => Note::new("compared.allowed_for")
                .with("difference", difference)
                .with("coefficient", Arg::figures(c, 3)),
            None => Note::new("compared.not_allowed_for").with("difference", difference),
        });
    }
    notes.extend(found.disturbing().map(|other| other.note("compared.in_step")));
    notes
}
