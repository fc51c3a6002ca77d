//! The noise of a gyro with every term there is: N, B, K, R, Q, Markov processes, quasi-periodic disturbances, lines,
//! and the bandwidth of the measurement.

mod bandwidth;
pub mod damped;
mod described;

pub use bandwidth::{Bandwidth, FlickerAliases, averaged_white_mode, filtered_white};
pub use damped::{Damped, Densities, Modes, Sampling, Windowed};
pub use described::{Described, Parameter, Propagated};

use super::data::NoiseType;
use super::model::{NoiseModel, TERMS, unit_allan_variance, unit_density, unit_mean_variance};
use std::f64::consts::PI;

/// A sinusoid that stays coherent over the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Amplitude, deg/h.
    pub amplitude_deg_h: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

/// One additive part of a [`Composite`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// N, B, K, Q or R.
    Term(NoiseType),
    /// First-order Markov noise, by position.
    Markov(usize),
    /// Quasi-periodic disturbance, by position.
    QuasiPeriodic(usize),
    /// Line, by position.
    Line(usize),
}

impl Part {
    /// Its name: the id of a noise type, `markov`, `quasi_periodic` or `line`.
    pub fn id(self) -> &'static str {
        match self {
            Part::Term(term) => term.id(),
            Part::Markov(_) => "markov",
            Part::QuasiPeriodic(_) => "quasi_periodic",
            Part::Line(_) => "line",
        }
    }
}

/// The noise of one channel. Everything is the continuous rate; samples are taken as `sampling` says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Composite {
    /// N, B, K, R, Q.
    pub terms: NoiseModel,
    /// First-order Markov processes.
    pub markov: Vec<Damped>,
    /// Quasi-periodic disturbances.
    pub quasi_periodic: Vec<Damped>,
    /// Coherent lines.
    pub lines: Vec<Line>,
    /// Filter of the output before it is sampled. Acts on N, B and K.
    pub bandwidth: Option<Bandwidth>,
    /// How samples are taken.
    pub sampling: Sampling,
}

impl From<NoiseModel> for Composite {
    fn from(terms: NoiseModel) -> Composite {
        Composite { terms, ..Default::default() }
    }
}

impl Composite {
    /// What makes a deviation scatter: everything but the lines. A line adds to a deviation and does not scatter, so its
    /// slope is no evidence of degrees of freedom.
    pub fn without_lines(&self) -> Composite {
        Composite { lines: vec![], ..self.clone() }
    }

    /// The parts that are present, N, B, K, Q, R first.
    pub fn parts(&self) -> Vec<Part> {
        let terms = TERMS.into_iter().filter(|t| self.terms.coefficient(*t) != 0.0).map(Part::Term);
        terms
            .chain((0..self.markov.len()).map(Part::Markov))
            .chain((0..self.quasi_periodic.len()).map(Part::QuasiPeriodic))
            .chain((0..self.lines.len()).map(Part::Line))
            .collect()
    }

    fn damped(&self, part: Part) -> Option<&Damped> {
        match part {
            Part::Markov(i) => self.markov.get(i),
            Part::QuasiPeriodic(i) => self.quasi_periodic.get(i),
            _ => None,
        }
    }

    /// Two-sided density of the samples of `tau0_s` that a part gives, (deg/h)²/Hz; 0 for lines and the ramp, which
    /// have none.
    pub fn part_density(&self, part: Part, frequency_hz: f64, tau0_s: f64) -> f64 {
        match part {
            Part::Term(term) => {
                let c2 = self.terms.coefficient(term).powi(2);
                if c2 == 0.0 {
                    return 0.0;
                }
                c2 * match &self.bandwidth {
                    Some(filter) => filter.unit_density(term, frequency_hz, tau0_s, self.sampling),
                    None => sampled_density(term, frequency_hz, tau0_s, self.sampling),
                }
            }
            Part::Line(_) => 0.0,
            _ => self.damped(part).map_or(0.0, |d| d.density(frequency_hz, tau0_s, self.sampling)),
        }
    }

    /// V(t) of a part, (deg/h)²: the variance of its mean over `t_s`, up to a constant for parts that are not
    /// stationary. `tau0_s` is the sample interval, which a moving average is counted in.
    pub fn part_mean_variance(&self, part: Part, t_s: f64, tau0_s: f64) -> f64 {
        match part {
            Part::Term(NoiseType::AngleRandomWalk) => {
                let n2 = self.terms.n * self.terms.n;
                let plain = unit_mean_variance(NoiseType::AngleRandomWalk, t_s);
                n2 * self.bandwidth.as_ref().map_or(plain, |b| b.unit_white_mean_variance(t_s, tau0_s))
            }
            Part::Term(term) => {
                let c2 = self.terms.coefficient(term).powi(2);
                if c2 == 0.0 { 0.0 } else { c2 * unit_mean_variance(term, t_s) }
            }
            Part::Line(i) => self.lines.get(i).map_or(0.0, |l| {
                let x = PI * l.frequency_hz * t_s;
                let sinc = if x.abs() < 1e-9 { 1.0 } else { x.sin() / x };
                0.5 * (l.amplitude_deg_h * sinc).powi(2)
            }),
            _ => self.damped(part).map_or(0.0, |d| d.mean_variance(t_s)),
        }
    }

    /// Allan variance of a part at `tau_s`, (deg/h)².
    pub fn part_allan_variance(&self, part: Part, tau_s: f64, tau0_s: f64) -> f64 {
        match part {
            Part::Term(term) if self.bandwidth.is_none() || term != NoiseType::AngleRandomWalk => {
                let c2 = self.terms.coefficient(term).powi(2);
                if c2 == 0.0 { 0.0 } else { c2 * unit_allan_variance(term, tau_s) }
            }
            Part::Line(i) => self.lines.get(i).map_or(0.0, |l| {
                let x = PI * l.frequency_hz * tau_s;
                if x.abs() < 1e-9 { 0.0 } else { (l.amplitude_deg_h * x.sin().powi(2) / x).powi(2) }
            }),
            Part::Markov(_) | Part::QuasiPeriodic(_) => {
                self.damped(part).map_or(0.0, |d| d.allan_variance(tau_s))
            }
            Part::Term(_) => {
                let v = |t| self.part_mean_variance(part, t, tau0_s);
                (2.0 * (v(tau_s) - v(2.0 * tau_s))).max(0.0)
            }
        }
    }

    /// E\[s²\] of `windows` adjacent means over `tau_s` that a part gives, (deg/h)²; `None` below two windows.
    pub fn part_expected_variance(&self, part: Part, tau_s: f64, windows: u64, tau0_s: f64) -> Option<f64> {
        if windows < 2 {
            return None;
        }
        let n = windows as f64;
        let v = |t| self.part_mean_variance(part, t, tau0_s);
        Some((n / (n - 1.0) * (v(tau_s) - v(n * tau_s))).max(0.0))
    }

    /// Density of all parts, (deg/h)²/Hz.
    pub fn density(&self, frequency_hz: f64, tau0_s: f64) -> f64 {
        self.parts().into_iter().map(|p| self.part_density(p, frequency_hz, tau0_s)).sum()
    }

    /// Allan variance of all parts, (deg/h)².
    pub fn allan_variance(&self, tau_s: f64, tau0_s: f64) -> f64 {
        self.parts().into_iter().map(|p| self.part_allan_variance(p, tau_s, tau0_s)).sum()
    }

    /// V(t) of all parts, (deg/h)².
    pub fn mean_variance(&self, t_s: f64, tau0_s: f64) -> f64 {
        self.parts().into_iter().map(|p| self.part_mean_variance(p, t_s, tau0_s)).sum()
    }

    /// E\[s²\] of all parts, (deg/h)²; `None` below two windows.
    pub fn expected_variance(&self, tau_s: f64, windows: u64, tau0_s: f64) -> Option<f64> {
        self.parts().into_iter().map(|p| self.part_expected_variance(p, tau_s, windows, tau0_s)).sum()
    }
}

impl Composite {
    /// The kind of power-law noise that the model is most like at `tau_s`: what the degrees of freedom of a deviation
    /// there follow. A Markov process is white noise when averaged over longer than 1.9 times its correlation time and
    /// random walk over less; an oscillation is random walk below its maximum and white angle noise beyond.
    pub fn dominant(&self, tau_s: f64, tau0_s: f64) -> NoiseType {
        let largest = self
            .parts()
            .into_iter()
            .map(|part| (part, self.part_allan_variance(part, tau_s, tau0_s)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let below = |turning_s: f64, later: NoiseType| {
            if tau_s < turning_s { NoiseType::RateRandomWalk } else { later }
        };
        match largest {
            Some((Part::Term(term), _)) => term,
            Some((Part::Markov(i), _)) => {
                let time_s = self.markov.get(i).map_or(0.0, |d| d.decay_time_s);
                below(1.89 * time_s, NoiseType::AngleRandomWalk)
            }
            Some((Part::QuasiPeriodic(i), _)) => {
                let frequency_hz = self.quasi_periodic.get(i).map_or(0.0, |d| d.frequency_hz);
                below(0.371 / frequency_hz, NoiseType::Quantization)
            }
            Some((Part::Line(i), _)) => {
                let frequency_hz = self.lines.get(i).map_or(0.0, |l| l.frequency_hz);
                below(0.371 / frequency_hz, NoiseType::Quantization)
            }
            None => NoiseType::AngleRandomWalk,
        }
    }

    /// A copy with one of N, B, K, R and Q alone, sampled and filtered as before.
    pub fn alone(&self, term: NoiseType) -> Composite {
        Composite {
            terms: NoiseModel::default().with(term, self.terms.coefficient(term)),
            bandwidth: self.bandwidth,
            sampling: self.sampling,
            ..Default::default()
        }
    }

    /// A copy without the ramp, which is no noise.
    #[must_use]
    pub fn without_ramp(&self) -> Composite {
        let mut out = self.clone();
        out.terms.r = 0.0;
        out
    }
}

/// Density of samples of an unfiltered term for a coefficient of 1. Instantaneous samples of white and flicker rate
/// noise have no finite variance without a filter: their density is that of the continuous rate, with what folds back
/// counted in N.
pub(crate) fn sampled_density(term: NoiseType, frequency_hz: f64, tau0_s: f64, sampling: Sampling) -> f64 {
    match (sampling, term) {
        (Sampling::Instantaneous, NoiseType::RateRandomWalk) => {
            let sin = (PI * frequency_hz * tau0_s).sin();
            (tau0_s / (2.0 * sin)).powi(2) / 3600.0
        }
        (Sampling::Instantaneous, NoiseType::Flicker) => 1.0 / (2.0 * PI * frequency_hz),
        _ => unit_density(term, frequency_hz, tau0_s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Composite {
        Composite {
            terms: NoiseModel { n: 0.002, b: 0.003, k: 0.001, r: 0.0005, q: 0.1 },
            markov: vec![Damped { rms_deg_h: 0.01, frequency_hz: 0.0, decay_time_s: 300.0 }],
            quasi_periodic: vec![Damped { rms_deg_h: 0.02, frequency_hz: 0.01, decay_time_s: 500.0 }],
            lines: vec![Line { amplitude_deg_h: 0.01, frequency_hz: 0.3 }],
            bandwidth: None,
            sampling: Sampling::Averaging,
        }
    }

    #[test]
    fn allan_variances_follow_from_the_variance_of_means() {
        let mut model = all();
        for bandwidth in [
            None,
            Some(Bandwidth::FirstOrder { time_constant_s: 3.0 }),
            Some(Bandwidth::MovingAverage { samples: 4 }),
        ] {
            model.bandwidth = bandwidth;
            for part in model.parts() {
                if matches!(part, Part::Line(_)) {
                    continue;
                }
                for tau in [8.0, 100.0, 3000.0] {
                    let v = |t| model.part_mean_variance(part, t, 1.0);
                    let expected = 2.0 * (v(tau) - v(2.0 * tau));
                    let got = model.part_allan_variance(part, tau, 1.0);
                    assert!((got / expected - 1.0).abs() < 1e-9, "{part:?} {tau}");
                }
            }
        }
    }

    #[test]
    fn the_expected_variance_of_two_windows_is_the_allan_variance() {
        let model = all();
        for part in model.parts() {
            if matches!(part, Part::Line(_)) {
                continue;
            }
            let two = model.part_expected_variance(part, 100.0, 2, 1.0).unwrap();
            assert!((two / model.part_allan_variance(part, 100.0, 1.0) - 1.0).abs() < 1e-9, "{part:?}");
        }
        assert_eq!(model.expected_variance(100.0, 1, 1.0), None);
    }

    #[test]
    fn what_a_part_is_most_like_follows_its_slope() {
        let model = all();
        // A Markov process alone, on both sides of its hump; an oscillation on both sides of its maximum.
        let markov = Composite { markov: model.markov.clone(), ..Default::default() };
        assert_eq!(markov.dominant(100.0, 1.0), NoiseType::RateRandomWalk);
        assert_eq!(markov.dominant(1000.0, 1.0), NoiseType::AngleRandomWalk);
        let periodic = Composite { quasi_periodic: model.quasi_periodic.clone(), ..Default::default() };
        assert_eq!(periodic.dominant(10.0, 1.0), NoiseType::RateRandomWalk);
        assert_eq!(periodic.dominant(100.0, 1.0), NoiseType::Quantization);
        assert_eq!(Composite::from(model.terms).dominant(1e-2, 1e-2), NoiseType::Quantization);
        assert_eq!(Composite::default().dominant(1.0, 1.0), NoiseType::AngleRandomWalk);
    }

    #[test]
    fn a_moving_average_lowers_the_allan_variance_as_published() {
        // (N²/τ)(1 − L/2τ) with L = (n − 1/n)τ0.
        let mut model = Composite::from(NoiseModel { n: 1.0, ..Default::default() });
        model.bandwidth = Some(Bandwidth::MovingAverage { samples: 5 });
        let tau: f64 = 40.0;
        let expected = 3600.0 / tau * (1.0 - (5.0 - 0.2) / (2.0 * tau));
        assert!((model.allan_variance(tau, 1.0) / expected - 1.0).abs() < 1e-9);
    }
}
