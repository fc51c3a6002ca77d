//! The level that is read off a curve as angle random walk: white noise, and every process that is white there.
//!
//! A process is white over averaging times far beyond its correlation time, and adds 2σ²T to the density of the white noise. Where
//! no line of slope −1/2 is seen before its corner, a reader of the curve reads both as one. A resonance is white far below
//! its frequency: its foot there is 2σ²T/(1 + (2πf₀T)²).

use super::fit::Joint;
use super::interval::parameter_covariance;
use super::model::{Free, JointPoint};
use crate::estimate::Spread;
use crate::message::{Note, note};
use crate::noise::composite::{Composite, Damped, Described, Propagated};
use crate::noise::data::NoiseType;
use crate::noise::model::NoiseModel;
use crate::noise::slope::{LARGEST_SHARE, SlopePoint, runs};
use std::f64::consts::PI;

/// Share of the level that the foot of a resonance has at least where it counts, in density.
const MIN_SHARE_OF_FOOT: f64 = 0.01;
/// Share of the octaves of the longest line from which a line at shorter averaging times is the one that is read.
const MIN_SHARE_OF_LONGEST: f64 = 0.5;

/// A line of slope −1/2 through the curve of a model, with the processes that are white on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Plateau {
    from_s: f64,
    to_s: f64,
    white: Vec<usize>,
    feet: Vec<usize>,
}

impl Plateau {
    /// The line that is read of a model; `None` where there is none, or no process is white on it.
    pub fn of(model: &Composite, tau0_s: f64, length_s: f64) -> Option<Plateau> {
        if model.markov.is_empty() && model.quasi_periodic.is_empty() {
            return None;
        }
        let octaves: Vec<SlopePoint> = (0..63)
            .map(|k| tau0_s * 2f64.powi(k))
            .take_while(|tau_s| *tau_s <= LARGEST_SHARE * length_s)
            .map(|tau_s| {
                let deviation = model.allan_variance(tau_s, tau0_s).max(f64::MIN_POSITIVE).sqrt();
                SlopePoint { tau_s, deviation, edf: 1.0 }
            })
            .collect();
        let lines = runs(&octaves, NoiseType::AngleRandomWalk);
        let longest = lines.iter().map(|r| r.len() - 1).max()? as f64;
        let line = octaves
            .get(lines.into_iter().find(|r| (r.len() - 1) as f64 >= MIN_SHARE_OF_LONGEST * longest)?)?;
        let (from_s, to_s) = (line.first()?.tau_s, line.last()?.tau_s);
        let middle_s = (from_s * to_s).sqrt();
        let white: Vec<usize> = model
            .markov
            .iter()
            .enumerate()
            .filter(|(_, d)| d.rms_deg_h > 0.0 && d.decay_time_s < middle_s)
            .map(|(i, _)| i)
            .collect();
        let foot = |d: &Damped| if d.frequency_hz * middle_s > 1.0 { density_at_zero(d) } else { 0.0 };
        let floor = model.terms.n.powi(2)
            + white.iter().filter_map(|i| model.markov.get(*i)).map(density_at_zero).sum::<f64>()
            + model.quasi_periodic.iter().map(foot).sum::<f64>();
        let counts = |(i, d): (usize, &Damped)| (foot(d) > MIN_SHARE_OF_FOOT * floor).then_some(i);
        let feet: Vec<usize> = model.quasi_periodic.iter().enumerate().filter_map(counts).collect();
        (!white.is_empty() || !feet.is_empty()).then_some(Plateau { from_s, to_s, white, feet })
    }

    fn processes<'a>(&'a self, model: &'a Composite) -> impl Iterator<Item = &'a Damped> {
        let feet = self.feet.iter().filter_map(|i| model.quasi_periodic.get(*i));
        self.white.iter().filter_map(|i| model.markov.get(*i)).chain(feet)
    }

    /// The level of a model, deg/√h.
    pub fn level(&self, model: &Composite) -> f64 {
        (model.terms.n.powi(2) + self.processes(model).map(density_at_zero).sum::<f64>()).sqrt()
    }

    /// The parts of a model that make up the level.
    pub fn parts(&self, model: &Composite) -> Composite {
        Composite {
            terms: NoiseModel { n: model.terms.n, ..Default::default() },
            markov: self.white.iter().filter_map(|i| model.markov.get(*i).copied()).collect(),
            quasi_periodic: self.feet.iter().filter_map(|i| model.quasi_periodic.get(*i).copied()).collect(),
            bandwidth: model.bandwidth,
            sampling: model.sampling,
            ..Default::default()
        }
    }

    /// Spread of the level, from a fit. The level is that of a stretch of the spectrum: its square is nearly
    /// normal by its logarithm, whatever its parts are known to.
    pub(super) fn spread(&self, joint: &Joint<'_>, point: &JointPoint, free: &Free) -> Spread {
        let (variables, covariance) = parameter_covariance(joint, point, free);
        let described = Described {
            model: point.composite(joint.sampling()),
            parameters: variables.iter().filter_map(|v| point.parameter(*v)).collect(),
            covariance,
        };
        let Propagated { value, standard_uncertainty: u } = described.propagate(|m| self.level(m));
        if !(value > 0.0 && u > 0.0 && u.is_finite()) {
            return Spread::Unknown;
        }
        let at = |i: i32| 0.25 * f64::from(i);
        Spread::Curve((-16..=16).map(|i| (at(i), value * (at(i) * u / value).exp())).collect())
    }

    /// Says which averaging times the level is read at.
    pub(super) fn note(&self) -> Note {
        note!("note.plateau", from_s = self.from_s, to_s = self.to_s)
    }
}

/// Density of a process at zero frequency, deg²/h.
fn density_at_zero(d: &Damped) -> f64 {
    let turned = 2.0 * PI * d.frequency_hz * d.decay_time_s;
    2.0 * d.rms_deg_h.powi(2) * d.decay_time_s / (1.0 + turned * turned) / 3600.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(time_s: f64, rms: f64) -> Composite {
        Composite {
            terms: NoiseModel { n: 0.01, ..Default::default() },
            markov: vec![Damped { rms_deg_h: rms, frequency_hz: 0.0, decay_time_s: time_s }],
            ..Default::default()
        }
    }

    #[test]
    fn a_short_process_belongs_to_what_is_read_and_a_long_one_does_not() {
        // 2σ²T/3600 = 3e-4: together 0.02.
        let rms = |time_s: f64| (3e-4 * 3600.0 / (2.0 * time_s)).sqrt();
        let short = with(1.5, rms(1.5));
        let plateau = Plateau::of(&short, 1.0, 36_000.0).unwrap();
        assert!((plateau.level(&short) / 0.02 - 1.0).abs() < 1e-9, "{plateau:?}");
        assert_eq!(Plateau::of(&with(300.0, rms(300.0)), 1.0, 36_000.0), None);
        assert_eq!(Plateau::of(&with(300.0, 0.0), 1.0, 36_000.0), None);
    }
    #[test]
    fn the_foot_of_a_resonance_belongs_to_what_is_read() {
        // A resonance at 0.3 Hz that decays in 2 s: 1 + (2π·0.3·2)² = 15.2.
        let turned = 2.0 * PI * 0.6;
        let rms = (3e-4 * 3600.0 * (1.0 + turned * turned) / 4.0f64).sqrt();
        let resonance = |rms_deg_h| Composite {
            quasi_periodic: vec![Damped { rms_deg_h, frequency_hz: 0.3, decay_time_s: 2.0 }],
            ..Composite::from(NoiseModel { n: 0.01, ..Default::default() })
        };
        let plateau = Plateau::of(&resonance(rms), 1.0, 36_000.0).unwrap();
        assert!((plateau.level(&resonance(rms)) / 0.02 - 1.0).abs() < 1e-9, "{plateau:?}");
        assert_eq!(Plateau::of(&resonance(0.01 * rms), 1.0, 36_000.0), None);
    }
}
