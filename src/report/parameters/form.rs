//! The noise that the form of a target can hold, and the error that it leaves: its Allan deviation over that of everything that was
//! measured.

use super::axis::{Axis, Level, gauss_markov};
use crate::noise::composite::{Composite, Damped};
use crate::noise::data::NoiseType;
use crate::noise::model::{NoiseModel, unit_allan_variance};
use std::f64::consts::PI;

/// How a form holds the flicker noise of the bias.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlickerForm {
    /// Not at all.
    LeftOut,
    /// As flicker noise.
    Exact,
    /// As one Gauss-Markov process.
    OneProcess,
    /// As Gauss-Markov processes a decade of correlation time apart.
    Chain,
}

/// The noise terms that a form has places for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Places {
    /// White noise of the rate.
    pub white: bool,
    /// Random walk of the rate.
    pub random_walk: bool,
    /// Flicker noise of the bias.
    pub flicker: FlickerForm,
}

/// Averaging time of the largest Allan deviation of a Gauss-Markov process, over its correlation time.
const PEAK_OVER_CORRELATION_TIME: f64 = 1.8926;

/// Longest averaging time of a comparison, as a share of the recording.
const LONGEST_SHARE: f64 = 0.2;

/// The averaging times at which a form is compared: octaves, from one sample to a fifth of the recording, s.
fn times(axis: &Axis) -> Vec<f64> {
    let shortest = axis.sample_interval_s.unwrap_or(1.0);
    let longest = LONGEST_SHARE * axis.duration_s;
    std::iter::successors(Some(shortest), |tau| Some(2.0 * tau)).take_while(|tau| *tau <= longest).collect()
}

/// Allan deviation, deg/h.
pub fn allan_deviation(noise: &Composite, tau_s: f64, axis: &Axis) -> f64 {
    noise.allan_variance(tau_s, axis.sample_interval_s.unwrap_or(1.0)).sqrt()
}

/// The averaging time of the smallest Allan deviation of what was measured, s.
fn time_of_minimum(axis: &Axis) -> Option<f64> {
    let noise = axis.measured();
    let at = |tau: &f64| allan_deviation(&noise, *tau, axis);
    times(axis).into_iter().min_by(|a, b| at(a).total_cmp(&at(b)))
}

/// The smallest Allan deviation of what was measured, deg/h.
pub fn smallest_deviation(axis: &Axis) -> Option<f64> {
    let tau = time_of_minimum(axis)?;
    Some(allan_deviation(&axis.measured(), tau, axis)).filter(|d| *d > 0.0)
}

/// The one Gauss-Markov process that stands for the slow noise of an axis: the Markov process with the largest standard deviation
/// where one was measured. Otherwise the process whose largest Allan deviation is the floor 0.664 B, at the averaging time at which
/// the measured deviation is smallest.
pub fn one_process(axis: &Axis) -> Option<Damped> {
    let largest = axis.markov.iter().max_by(|a, b| a.rms_deg_h.total_cmp(&b.rms_deg_h));
    if let Some(process) = largest {
        return Some(*process);
    }
    let floor = axis.flicker.used()? * unit_allan_variance(NoiseType::Flicker, 1.0).sqrt();
    let peak_s = time_of_minimum(axis)?;
    let of_unit = gauss_markov(1.0, peak_s / PEAK_OVER_CORRELATION_TIME);
    Some(Damped { rms_deg_h: floor / of_unit.allan_variance(peak_s).sqrt(), ..of_unit })
}

/// Ratio of neighbouring correlation times in a chain.
const CHAIN_RATIO: f64 = 10.0;

/// Gauss-Markov processes whose densities add up to B²/(2πf) within 6 %, from correlation times of one sample to those of the
/// recording: each has the variance B² ln r/π, with the ratio r of their times.
pub fn chain(axis: &Axis) -> Vec<Damped> {
    let Some(b) = axis.flicker.used().filter(|b| *b > 0.0) else { return vec![] };
    let rms = b * (CHAIN_RATIO.ln() / PI).sqrt();
    // The band that a process of time T holds lies about 1/(2πT).
    let shortest = axis.sample_interval_s.unwrap_or(1.0) / PI;
    std::iter::successors(Some(shortest), |t| Some(CHAIN_RATIO * t))
        .take_while(|t| *t < CHAIN_RATIO * axis.duration_s)
        .map(|t| gauss_markov(rms, t))
        .collect()
}

impl Places {
    /// The noise that a form holds of an axis.
    pub fn held(&self, axis: &Axis) -> Composite {
        let used = |has: bool, level: Level| level.used().filter(|_| has).unwrap_or(0.0);
        let markov = match self.flicker {
            FlickerForm::LeftOut | FlickerForm::Exact => vec![],
            FlickerForm::OneProcess => one_process(axis).into_iter().collect(),
            FlickerForm::Chain => axis.markov.iter().copied().chain(chain(axis)).collect(),
        };
        Composite {
            terms: NoiseModel {
                n: used(self.white, axis.white),
                b: used(self.flicker == FlickerForm::Exact, axis.flicker),
                k: used(self.random_walk, axis.random_walk),
                ..NoiseModel::default()
            },
            markov,
            ..Composite::default()
        }
    }

    /// True where the form holds the flicker noise of an axis in some way.
    pub fn holds_flicker(&self, axis: &Axis) -> bool {
        match self.flicker {
            FlickerForm::LeftOut => false,
            FlickerForm::Exact | FlickerForm::Chain => true,
            FlickerForm::OneProcess => axis.markov.is_empty(),
        }
    }

    /// Number of measured Markov processes that the form holds.
    pub fn markov_held(&self, axis: &Axis) -> usize {
        match self.flicker {
            FlickerForm::LeftOut | FlickerForm::Exact => 0,
            FlickerForm::OneProcess => axis.markov.len().min(1),
            FlickerForm::Chain => axis.markov.len(),
        }
    }
}

/// A ratio of deviations at an averaging time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatioAt {
    /// Deviation of the form over that of everything measured.
    pub ratio: f64,
    /// Averaging time, s.
    pub tau_s: f64,
}

/// The error that a form leaves over all averaging times that the recording shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormError {
    /// Where the form states least.
    pub lowest: RatioAt,
    /// Where it states most.
    pub highest: RatioAt,
    /// Shortest averaging time, s.
    pub from_s: f64,
    /// Longest averaging time, s.
    pub to_s: f64,
}

impl FormError {
    /// The error of what a form holds of an axis; `None` where nothing was measured.
    pub fn of(held: &Composite, axis: &Axis) -> Option<FormError> {
        let whole = axis.measured();
        let ratios: Vec<RatioAt> = times(axis)
            .into_iter()
            .map(|tau_s| {
                let ratio = allan_deviation(held, tau_s, axis) / allan_deviation(&whole, tau_s, axis);
                RatioAt { ratio, tau_s }
            })
            .filter(|r| r.ratio.is_finite())
            .collect();
        let lowest = ratios.iter().copied().min_by(|a, b| a.ratio.total_cmp(&b.ratio))?;
        let highest = ratios.iter().copied().max_by(|a, b| a.ratio.total_cmp(&b.ratio))?;
        let (from_s, to_s) = (ratios.first()?.tau_s, ratios.last()?.tau_s);
        Some(FormError { lowest, highest, from_s, to_s })
    }

    /// Least factor on all noise quantities with which the form understates the deviation nowhere.
    pub fn inflation(&self) -> f64 {
        if self.lowest.ratio > 0.0 { (1.0 / self.lowest.ratio).max(1.0) } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::super::example::{record, row};
    use super::*;
    use crate::measurand::{ANGLE_RANDOM_WALK, BIAS_INSTABILITY, RATE_RANDOM_WALK};

    fn axis(n: f64, b: f64, k: f64) -> Axis {
        let rows = [(&ANGLE_RANDOM_WALK, n), (&BIAS_INSTABILITY, b), (&RATE_RANDOM_WALK, k)];
        let rows = rows.into_iter().filter(|(_, v)| *v > 0.0).map(|(m, v)| row(m, "x", v)).collect();
        Axis::all(&record(rows)).remove(0)
    }

    const KALIBR: Places = Places { white: true, random_walk: true, flicker: FlickerForm::LeftOut };

    #[test]
    fn a_form_that_holds_everything_leaves_no_error() {
        let axis = axis(0.1, 0.0, 0.5);
        let error = FormError::of(&KALIBR.held(&axis), &axis).unwrap();
        assert!((error.lowest.ratio - 1.0).abs() < 1e-12 && (error.highest.ratio - 1.0).abs() < 1e-12);
        assert_eq!((error.from_s, error.inflation()), (0.1, 1.0));
        assert!(error.to_s <= 7200.0 && error.to_s > 3600.0);
    }

    #[test]
    fn flicker_that_is_left_out_is_the_error_at_the_floor() {
        let axis = axis(0.01, 1.0, 0.0);
        let error = FormError::of(&KALIBR.held(&axis), &axis).unwrap();
        // σ² = N²/τ + 2 ln 2/π B², by hand at the longest time: 0.1·2^16 s.
        let tau_h = 0.1 * 65_536.0 / 3600.0;
        let white = 1e-4 / tau_h;
        let expected = (white / (white + 2.0 * 2f64.ln() / PI)).sqrt();
        assert!((error.lowest.ratio / expected - 1.0).abs() < 1e-9, "{error:?} {expected}");
        assert!((error.inflation() * expected - 1.0).abs() < 1e-9);
    }

    #[test]
    fn one_process_has_its_peak_at_the_floor() {
        let axis = axis(0.01, 1.0, 1.0);
        let process = one_process(&axis).unwrap();
        let floor = (2.0 * 2f64.ln() / PI).sqrt();
        let peak_s = PEAK_OVER_CORRELATION_TIME * process.decay_time_s;
        assert!((process.allan_variance(peak_s).sqrt() / floor - 1.0).abs() < 1e-9);
        for other in [0.9, 1.1] {
            assert!(process.allan_variance(other * peak_s) < process.allan_variance(peak_s));
        }
        // A process that was measured goes first.
        let mut with = axis.clone();
        with.markov = vec![gauss_markov(2.0, 50.0)];
        assert_eq!(one_process(&with), Some(gauss_markov(2.0, 50.0)));
    }

    #[test]
    fn a_chain_has_the_density_of_flicker_noise() {
        let axis = axis(0.01, 1.0, 0.0);
        let chain = chain(&axis);
        for f in [1e-4, 1e-3, 3e-3, 1e-2, 0.1] {
            // Two-sided density of a Gauss-Markov process: 2σ²T/(1 + (2πfT)²).
            let density: f64 = chain
                .iter()
                .map(|d| {
                    let t = d.decay_time_s;
                    2.0 * d.rms_deg_h.powi(2) * t / (1.0 + (2.0 * PI * f * t).powi(2))
                })
                .sum();
            assert!((density * 2.0 * PI * f - 1.0).abs() < 0.08, "{f}: {}", density * 2.0 * PI * f);
        }
    }

    #[test]
    fn nothing_measured_gives_no_error() {
        let mut axis = axis(0.1, 0.0, 0.0);
        axis.white = Level::AtMost { value: 0.1, coverage: 0.95 };
        assert_eq!(FormError::of(&KALIBR.held(&axis), &axis), None);
        assert_eq!(one_process(&axis), None);
        assert!(chain(&axis).is_empty());
    }
}
