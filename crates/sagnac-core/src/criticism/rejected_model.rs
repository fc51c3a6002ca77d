//! Whether the record departs from the fitted model by more than chance and more than is harmless, at frequencies or averaging
//! times that a term was read from.

use super::affected::{NOISE_OF_FIT, SLOW_NOISE};
use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, Note, note};
use crate::noise::composite::Part;
use crate::noise::data::NoiseType;
use crate::noise::residual::{Departure, View};

/// Ratio of deviations from which a departure matters, either way.
const MIN_RATIO: f64 = 1.25;
/// Share of the model that a term has where it is read.
const MIN_SHARE: f64 = 0.25;
/// Share of the record from which an averaging time is one of slow noise.
const SLOW_SHARE: f64 = 0.003;
/// Probability of the misfit below which a record is described by no term, where none was accepted.
const UNDESCRIBED_PROBABILITY: f64 = 1e-3;
/// Ratio of the ends of a departure from which it is broad: a narrow one is a resonance beside the white noise.
const MIN_RATIO_OF_BROAD: f64 = 2.0;

/// Finds the departures, or that nothing describes the record.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    undescribed(gyro).map_or_else(|| departures(gyro), |finding| vec![finding])
}

/// A record without any accepted term that is not the sum of what their upper limits allow: no limit follows from such a fit.
fn undescribed(gyro: &GyroEvidence) -> Option<Finding> {
    let misfit = gyro.identification.misfit;
    let nothing_judged = gyro.goodness.views.is_empty();
    (nothing_judged && misfit.probability < UNDESCRIBED_PROBABILITY).then(|| Finding {
        measurands: NOISE_OF_FIT.into_iter().chain(SLOW_NOISE).collect(),
        holds: Holds::Nothing,
        found: note!("criticism_found.undescribed", misfit = Arg::rounded(misfit.per_dof, 2)),
        advice: note!("criticism_advice.rejected_model"),
    })
}

fn departures(gyro: &GyroEvidence) -> Vec<Finding> {
    let failures = gyro.goodness.failures();
    let mut found = vec![];
    for judged in failures {
        let Departure { from, to, excess } = judged.departure;
        let by_frequency = match judged.view {
            View::Frequency => true,
            View::AveragingTime => false,
            View::Lag | View::Amplitude | View::Jump => continue,
        };
        // Power departs by the square of what a deviation does.
        let ratio = if by_frequency { (1.0 + excess).max(0.0).sqrt() } else { 1.0 + excess };
        if (1.0 / MIN_RATIO..=MIN_RATIO).contains(&ratio) {
            continue;
        }
        let nyquist_hz = 0.5 / gyro.tau0_s;
        let highest_hz = gyro.identification.highest_hz.unwrap_or(nyquist_hz);
        let (low, high) = if by_frequency { (from, to.min(nyquist_hz)) } else { (from, to) };
        let middle = (low * high).sqrt();
        // A deviation at an averaging time has power of higher frequencies in it: it speaks of a model up to a frequency
        // only where it departs at longer times alone.
        let restricted = gyro.identification.highest_hz.is_some();
        let beyond = if by_frequency { low >= highest_hz } else { restricted && low < 1.0 / highest_hz };
        let tau_s = if by_frequency { 1.0 / middle } else { middle };
        if beyond || !middle.is_finite() || middle <= 0.0 {
            continue;
        }
        let mut measurands = vec![];
        if high >= MIN_RATIO_OF_BROAD * low && white_share(gyro, middle, by_frequency) >= MIN_SHARE {
            measurands.push("angle_random_walk");
        }
        if tau_s >= SLOW_SHARE * gyro.usable_s() {
            measurands.extend(SLOW_NOISE);
        }
        if measurands.is_empty() {
            continue;
        }
        let key = if by_frequency { "criticism_found.power" } else { "criticism_found.deviation" };
        found.push(Finding {
            measurands,
            holds: Holds::Nothing,
            found: Note::new(key)
                .with("from", Arg::rounded(low, 2))
                .with("to", Arg::rounded(high, 2))
                .with("ratio", Arg::rounded(if by_frequency { 1.0 + excess } else { ratio }, 2)),
            advice: note!("criticism_advice.rejected_model"),
        });
    }
    found
}

/// Share of the white noise in the model at a frequency or averaging time.
fn white_share(gyro: &GyroEvidence, at: f64, by_frequency: bool) -> f64 {
    let (model, tau0_s) = (&gyro.identification.described.model, gyro.tau0_s);
    let white = Part::Term(NoiseType::AngleRandomWalk);
    if by_frequency {
        model.part_density(white, at, tau0_s) / model.density(at, tau0_s)
    } else {
        model.part_allan_variance(white, at, tau0_s) / model.allan_variance(at, tau0_s)
    }
}
