//! The values of Russian practice: standard deviations of 100-s and 10-s means, and the angle random walk from 10-s
//! means. Definitions of the founding paper, made explicit: n − 1, mean removed only, remainder dropped.

use super::descriptor::{Measurand, PowerModel};
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::{Note, note};
use crate::noise::windows::{WindowStatistics, edf_of_window_std};

/// Window of the drift figure, s.
pub const DRIFT_WINDOW_S: f64 = 100.0;
/// Window of the angle-random-walk figure, s.
pub const RANDOM_WALK_WINDOW_S: f64 = 10.0;

/// Drift of 100-s means, one sigma.
pub static RUSSIAN_DRIFT_100S: Measurand = Measurand::at_rest(
    "russian_drift_100s",
    "deg/h",
    "standard deviation of consecutive 100-s means, one sigma",
    |m, gyro, _| vec![of_means(m, gyro, DRIFT_WINDOW_S, 1.0)],
)
.power(PowerModel::WindowMeans { window_s: DRIFT_WINDOW_S })
.drift();

/// Drift of 100-s means, three sigma.
pub static RUSSIAN_DRIFT_100S_3SIGMA: Measurand = Measurand::at_rest(
    "russian_drift_100s_3sigma",
    "deg/h",
    "three times the standard deviation of consecutive 100-s means",
    |m, gyro, _| vec![of_means(m, gyro, DRIFT_WINDOW_S, 3.0)],
)
.power(PowerModel::WindowMeans { window_s: DRIFT_WINDOW_S })
.drift();

/// Standard deviation of 10-s means.
pub static RUSSIAN_SIGMA_10S: Measurand = Measurand::at_rest(
    "russian_sigma_10s",
    "deg/h",
    "standard deviation of consecutive 10-s means",
    |m, gyro, _| vec![of_means(m, gyro, RANDOM_WALK_WINDOW_S, 1.0)],
)
.power(PowerModel::WindowMeans { window_s: RANDOM_WALK_WINDOW_S })
.drift();

/// Angle random walk from 10-s means.
pub static RUSSIAN_ARW_10S: Measurand = Measurand::at_rest(
    "russian_arw_10s",
    "deg/sqrt(h)",
    "angle random walk from 10-s means: sqrt(10) sigma / 60",
    // White noise over τ has σ = 60 N/√τ, so N = σ10 √10/60: the bandwidth is that of the averaging.
    |m, gyro, _| vec![of_means(m, gyro, RANDOM_WALK_WINDOW_S, 10f64.sqrt() / 60.0)],
)
.power(PowerModel::WindowMeans { window_s: RANDOM_WALK_WINDOW_S })
.drift();

/// A factor times the standard deviation of the means of windows.
fn of_means(m: &Measurand, gyro: &GyroEvidence, window_s: f64, factor: f64) -> Estimate {
    let method = "standard_deviation_of_means";
    let Some(windows) = gyro.windows(window_s) else {
        return m.not_identifiable(&gyro.channel, None, method).note(no_windows(gyro, window_s));
    };
    let dof = degrees_of_freedom(gyro, windows);
    let value = windows.standard_deviation * factor;
    let exact_s = windows.exact_s(gyro.tau0_s);
    let estimate = m.measured(&gyro.channel, value, Spread::ChiSquare { dof }, method).note(note!(
        "note.russian_windows",
        n = windows.n,
        window_s,
        hours = windows.n as f64 * exact_s / 3600.0,
        dof
    ));
    if (exact_s / window_s - 1.0).abs() > 1e-3 {
        return estimate.note(note!("note.russian_window_rounded", exact_s));
    }
    estimate
}

/// Why there are no windows of a length.
pub(super) fn no_windows(gyro: &GyroEvidence, window_s: f64) -> Note {
    if gyro.samples_fit(window_s) {
        return note!("note.russian_too_short", window_s);
    }
    note!("note.russian_window_unfit", window_s, interval_s = gyro.tau0_s)
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

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::test_evidence::{
        chi_square, gyro, near, notes, number, shows, windows, withholds, within,
    };
    use super::*;
    use crate::estimate::UpperLimit;
    use crate::noise::model::NoiseModel;

    fn with(of_100: (u64, u64), of_10: (u64, u64)) -> GyroEvidence {
        let mut gyro = gyro();
        gyro.digest.windows =
            vec![windows(100.0, of_100.0, of_100.1, 0.012), windows(10.0, of_10.0, of_10.1, 0.03)];
        gyro.identification.allowed = NoiseModel { n: 0.002, ..Default::default() }.into();
        gyro
    }

    fn row(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
        m.evaluate_gyro(gyro, &Options { remove_earth_rate: false }).remove(0)
    }

    #[test]
    fn every_figure_is_its_factor_times_the_deviation_of_means() {
        let gyro = with((200, 37), (20, 360));
        for (m, value, dof) in [
            (&RUSSIAN_DRIFT_100S, 0.012, 36.0),
            (&RUSSIAN_DRIFT_100S_3SIGMA, 0.036, 36.0),
            (&RUSSIAN_SIGMA_10S, 0.03, 359.0),
            // σ√10/60 = 0.03·3.16228/60.
            (&RUSSIAN_ARW_10S, 0.001_581_138_830_084_189_8, 359.0),
        ] {
            let found = row(m, &gyro);
            shows(&found, value, "standard_deviation_of_means");
            // White noise leaves n − 1.
            within(chi_square(&found), dof, 1e-6);
            assert_eq!(notes(&found), ["note.russian_windows"]);
        }
        let found = row(&RUSSIAN_DRIFT_100S, &gyro);
        near(number(&found, "note.russian_windows", "n"), 37.0);
        near(number(&found, "note.russian_windows", "window_s"), 100.0);
        near(number(&found, "note.russian_windows", "hours"), 3700.0 / 3600.0);
    }

    #[test]
    fn windows_of_another_length_are_named_or_refused() {
        // 101.5 s for 100 s is within 2 %; 100.1 s within 0.1 %.
        let found = row(&RUSSIAN_DRIFT_100S, &with((203, 37), (20, 360)));
        near(number(&found, "note.russian_window_rounded", "exact_s"), 101.5);
        let found = row(&RUSSIAN_DRIFT_100S, &with((197, 37), (20, 360)));
        near(number(&found, "note.russian_window_rounded", "exact_s"), 98.5);
        let unfit = row(&RUSSIAN_DRIFT_100S, &with((206, 37), (20, 360)));
        withholds(&unfit, None, "standard_deviation_of_means");
        near(number(&unfit, "note.russian_window_unfit", "interval_s"), 0.5);
        let short = row(&RUSSIAN_SIGMA_10S, &with((200, 37), (20, 1)));
        withholds(&short, None, "standard_deviation_of_means");
        assert_eq!(notes(&short), ["note.russian_too_short"]);
    }

    #[test]
    fn a_walk_that_is_not_shown_counts_with_a_share_of_its_limit() {
        let mut gyro = with((200, 37), (20, 360));
        let of = |gyro: &GyroEvidence| degrees_of_freedom(gyro, &gyro.digest.windows[0]);
        // A ramp shifts the value and scatters nothing.
        gyro.identification.allowed.terms.r = 1.0;
        within(of(&gyro), 36.0, 1e-6);
        gyro.identification.rate_random_walk.upper_limit = Some(UpperLimit { value: 0.05, coverage: 0.95 });
        let unseen = of(&gyro);
        assert!(unseen < 10.0, "{unseen}");
        gyro.identification.rate_random_walk.upper_limit = None;
        gyro.identification.allowed.terms.k = 0.03;
        near(of(&gyro), unseen);
        // A walk in the description that is larger already stays.
        gyro.identification.rate_random_walk.upper_limit = Some(UpperLimit { value: 0.04, coverage: 0.95 });
        near(of(&gyro), unseen);
    }
}
