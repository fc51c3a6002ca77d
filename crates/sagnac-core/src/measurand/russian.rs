//! The values of Russian practice: standard deviations of 100-s and 10-s means, and the angle random walk from 10-s
//! means. Definitions of the founding paper, made explicit: n − 1, mean removed only, remainder dropped.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread};
use crate::message::Note;
use crate::noise::windows::{WindowStatistics, edf_of_window_std};

pub(super) struct Russian;

/// Window of the drift figure, s.
pub const DRIFT_WINDOW_S: f64 = 100.0;
/// Window of the angle-random-walk figure, s.
pub const RANDOM_WALK_WINDOW_S: f64 = 10.0;

impl Measurand for Russian {
    fn ids(&self) -> &'static [&'static str] {
        &["russian_drift_100s", "russian_drift_100s_3sigma", "russian_sigma_10s", "russian_arw_10s"]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        let (id, window_s, factor, unit) = match id {
            "russian_drift_100s" => ("russian_drift_100s", DRIFT_WINDOW_S, 1.0, "deg/h"),
            "russian_drift_100s_3sigma" => ("russian_drift_100s_3sigma", DRIFT_WINDOW_S, 3.0, "deg/h"),
            "russian_sigma_10s" => ("russian_sigma_10s", RANDOM_WALK_WINDOW_S, 1.0, "deg/h"),
            // White noise over τ has σ = 60 N/√τ, so N = σ10 √10/60: the bandwidth is that of the averaging.
            "russian_arw_10s" => {
                ("russian_arw_10s", RANDOM_WALK_WINDOW_S, 10f64.sqrt() / 60.0, "deg/sqrt(h)")
            }
            _ => return None,
        };
        let method = "standard_deviation_of_means";
        let Some(windows) = gyro.windows(window_s) else {
            let none = Estimate::not_identifiable(id, &gyro.channel, None, unit, method);
            return Some(none.note(no_windows(gyro, window_s)));
        };
        let dof = degrees_of_freedom(gyro, windows);
        let value = windows.standard_deviation * factor;
        let mut estimate =
            Estimate::measured(id, &gyro.channel, value, unit, Spread::ChiSquare { dof }, method).note(
                Note::new("note.russian_windows")
                    .with("n", windows.n)
                    .with("window_s", window_s)
                    .with("hours", windows.n as f64 * windows.exact_s(gyro.tau0_s) / 3600.0)
                    .with("dof", dof),
            );
        let exact_s = windows.exact_s(gyro.tau0_s);
        if (exact_s / window_s - 1.0).abs() > 1e-3 {
            estimate = estimate.note(Note::new("note.russian_window_rounded").with("exact_s", exact_s));
        }
        Some(estimate)
    }
}

/// Why there are no windows of a length.
pub(super) fn no_windows(gyro: &GyroEvidence, window_s: f64) -> Note {
    if gyro.samples_fit(window_s) {
        return Note::new("note.russian_too_short").with("window_s", window_s);
    }
    Note::new("note.russian_window_unfit").with("window_s", window_s).with("interval_s", gyro.tau0_s)
}

/// Share of its upper limit that random walk is taken to have where the record does not show it (by simulation: so
/// that units with a walk just too weak to be claimed are not passed too often).
const UNSEEN_WALK: f64 = 0.6;

/// Degrees of freedom of the variance of the means under the noise of this record: correlated noise leaves few, and
/// it need not be certain to be there.
pub fn degrees_of_freedom(gyro: &GyroEvidence, windows: &WindowStatistics) -> f64 {
    let found = &gyro.identification;
    // A ramp is no noise: it shifts the value and does not scatter it.
    let mut model = found.allowed.without_ramp();
    if let Some(limit) = found.rate_random_walk.upper_limit {
        model.terms.k = model.terms.k.max(UNSEEN_WALK * limit.value);
    }
    let white = windows.n.saturating_sub(1) as f64;
    edf_of_window_std(windows.n, windows.window_s, |t| model.mean_variance(t, gyro.tau0_s))
        .unwrap_or(white)
        .max(1.0)
}
