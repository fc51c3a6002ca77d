//! The smallest Allan deviation, raw and over 0.664: two of the three figures that are called bias instability.
//!
//! The minimum is an extreme of a noisy curve. A record of angle random walk alone has one too, wherever it ends;
//! so it is reported with its τ and its degrees of freedom and is no evidence of a floor by itself.

use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::Note;
use crate::noise::intervals::BoundedPoint;
use crate::noise::residual::degrees_of_freedom;

/// The smallest Allan deviation.
pub static BIAS_INSTABILITY_MINIMUM: Measurand = Measurand::at_rest(
    "bias_instability_minimum",
    "deg/h",
    "minimum of the overlapping Allan deviation over octaves up to a fifth of the record",
    |m, gyro, _| vec![minimum(m, gyro, 1.0)],
)
.needs_stillness()
.drift();

/// The smallest Allan deviation as B, if flicker makes it.
pub static BIAS_INSTABILITY_MINIMUM_SCALED: Measurand = Measurand::at_rest(
    "bias_instability_minimum_scaled",
    "deg/h",
    "that minimum divided by 0.664",
    |m, gyro, _| vec![minimum(m, gyro, FLICKER_FLOOR)],
)
.needs_stillness()
.drift();

const METHOD: &str = "overlapping_allan";

/// √(2 ln 2/π): the Allan deviation of flicker noise is this times B.
pub const FLICKER_FLOOR: f64 = 0.664_282_470_3;

/// Largest averaging time read, as a share of the record (result contract).
const LARGEST_SHARE: f64 = 0.2;

fn minimum(m: &Measurand, gyro: &GyroEvidence, divisor: f64) -> Estimate {
    let readable = readable(gyro);
    let Some(lowest) = lowest(gyro) else {
        return m.not_identifiable(&gyro.channel, None, METHOD).note(Note::new("note.minimum_none"));
    };
    let tau_s = lowest.point.m as f64 * gyro.tau0_s;
    let edf = minimum_edf(gyro, lowest);
    let spread = Spread::ChiSquare { dof: edf };
    let estimate = m
        .measured(&gyro.channel, lowest.point.deviation / divisor, spread, METHOD)
        .note(Note::new("note.minimum_at").with("tau_s", tau_s).with("edf", edf));
    if readable.last().is_some_and(|last| last.point.m == lowest.point.m) {
        estimate.note(Note::new("note.minimum_at_end"))
    } else if gyro.identification.bias_instability.value.is_none() {
        estimate.note(Note::new("note.minimum_no_evidence"))
    } else {
        estimate
    }
}

/// The smallest deviation that is read.
pub fn lowest(gyro: &GyroEvidence) -> Option<&BoundedPoint> {
    let positive = readable(gyro).into_iter().filter(|p| p.point.deviation > 0.0);
    positive.min_by(|a, b| a.point.deviation.total_cmp(&b.point.deviation))
}

/// Degrees of freedom of the smallest deviation: those of the prevailing kind of noise, or of the whole description
/// where it holds lines, Markov processes or quasi-periodic disturbances and gives fewer.
pub fn minimum_edf(gyro: &GyroEvidence, lowest: &BoundedPoint) -> f64 {
    let model = &gyro.identification.described.model;
    if model.lines.is_empty() && model.markov.is_empty() && model.quasi_periodic.is_empty() {
        return lowest.edf;
    }
    let whole = degrees_of_freedom(model, &lowest.point, gyro.tau0_s);
    if whole > 0.0 { lowest.edf.min(whole.max(1.0)) } else { lowest.edf }
}

/// Octaves up to a fifth of the record.
pub fn readable(gyro: &GyroEvidence) -> Vec<&BoundedPoint> {
    let samples = gyro.digest.samples as f64;
    gyro.octaves.iter().filter(|p| p.point.m as f64 <= samples * LARGEST_SHARE).collect()
}
