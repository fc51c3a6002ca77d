//! No part of a record exceeds the record: amplitudes, deviations and coefficients of a fit against its range, its Allan
//! curve and the scatter of its means.
//!
//! A fit can put more into a part than there is: a disturbance whose top lies between two modes, a process beyond what the
//! record resolves. Such a part is withheld wherever it would stand: in a row, in a prediction, as a share.

use super::composite::{Composite, Parameter};
use super::data::NoiseType;
use super::digest::RateDigest;
use super::identification::Identification;
use super::intervals::BoundedPoint;
use super::lines::SpectralLine;
use super::model::TERMS;
use super::slope::LARGEST_SHARE;
use super::windows::edf_of_window_std;
use crate::estimate::{Estimate, chi_square_quantile};
use crate::message::{Note, note};

/// Share by which an amplitude may exceed half the range, for its own error.
const AMPLITUDE_ALLOWANCE: f64 = 1.02;
/// Factor by which a part may exceed what the record allows it, in deviation, before that contradicts it: no model of a real
/// output is better.
const DEVIATION_ALLOWANCE: f64 = 1.02;
/// Probability with which chance makes a record show less of a part than this.
const BOUND_PROBABILITY: f64 = 1e-3;
/// Least degrees of freedom of what a part is set against.
const LEAST_EDF: f64 = 3.0;

/// Bounds that a record as a whole sets on the size of each part of a model: its range, its Allan variances and the scatter
/// of its window means. A part that one of them excludes was fitted to something else.
#[derive(Debug, Clone, PartialEq)]
pub struct Whole {
    half_range: f64,
    /// Averaging times with the largest Allan variance that the record may stand for, (deg/h)².
    variances: Vec<(f64, f64)>,
    /// Window, windows and the variance of their means.
    windows: Vec<(f64, u64, f64)>,
    tau0_s: f64,
}

impl Whole {
    /// The bounds that a record sets. Below `1/highest_hz` the model is not meant to hold.
    pub fn of(digest: &RateDigest, octaves: &[BoundedPoint], highest_hz: Option<f64>) -> Whole {
        let tau0_s = digest.tau0_s;
        let shortest_s = highest_hz.map_or(0.0, |hz| 1.0 / hz);
        let most =
            |deviation: f64, dof: f64| deviation.powi(2) * dof / chi_square_quantile(BOUND_PROBABILITY, dof);
        let variances = octaves
            .iter()
            .filter(|p| p.edf >= LEAST_EDF && p.point.m as f64 <= LARGEST_SHARE * digest.samples as f64)
            .map(|p| (p.point.m as f64 * tau0_s, most(p.point.deviation, p.edf)))
            .filter(|(tau_s, variance)| *tau_s >= shortest_s && variance.is_finite())
            .collect();
        let windows = digest
            .windows
            .iter()
            .filter(|w| w.n >= 8 && w.fits(tau0_s) && w.window_s >= shortest_s)
            .map(|w| (w.window_s, w.n, w.standard_deviation.powi(2)))
            .filter(|w| w.2.is_finite())
            .collect();
        Whole { half_range: 0.5 * (digest.max - digest.min), variances, windows, tau0_s }
    }

    /// Least value of a part against the largest of the record; `None` where it fits.
    fn excess(&self, part: &Composite, size: f64, least: f64) -> Option<(f64, f64)> {
        let share = if size > 0.0 { (least / size).powi(2) } else { 0.0 };
        let beyond = |(has, most): (f64, f64)| {
            (has > DEVIATION_ALLOWANCE.powi(2) * most).then(|| (has.sqrt(), most.sqrt()))
        };
        let octaves = self.variances.iter();
        let at = octaves.map(|(tau_s, most)| (share * part.allan_variance(*tau_s, self.tau0_s), *most));
        let means = self.windows.iter().filter_map(|(window_s, n, variance)| {
            // Slow noise leaves the scatter of means few degrees of freedom; a line does not scatter.
            let scatter = |t: f64| part.mean_variance(t, self.tau0_s);
            let own =
                if part.lines.is_empty() { edf_of_window_std(*n, *window_s, scatter)? } else { f64::MAX };
            let dof = own.min((*n - 1) as f64);
            let most = variance * dof / chi_square_quantile(BOUND_PROBABILITY, dof);
            let has = share * part.expected_variance(*window_s, *n, self.tau0_s)?;
            most.is_finite().then_some((has, most))
        });
        at.chain(means).filter_map(beyond).max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))
    }

    /// Takes out the lines that the record cannot hold; the strongest of them, said.
    pub fn lines(&self, lines: &mut Vec<SpectralLine>) -> Option<Note> {
        let mut said: Option<(f64, Note)> = None;
        lines.retain(|line| {
            let amplitude = line.amplitude_deg_h;
            let part = Composite {
                lines: vec![super::composite::Line {
                    amplitude_deg_h: amplitude,
                    frequency_hz: line.frequency_hz,
                }],
                ..Default::default()
            };
            let most = if amplitude > AMPLITUDE_ALLOWANCE * self.half_range {
                Some((amplitude, self.half_range))
            } else {
                self.excess(&part, 1.0, 1.0)
            };
            let Some((has, most)) = most else { return true };
            if said.as_ref().is_none_or(|(largest, _)| amplitude > *largest) {
                let note =
                    note!("note.line_beyond_record", amplitude, frequency_hz = line.frequency_hz, has, most);
                said = Some((amplitude, note));
            }
            false
        });
        said.map(|(_, note)| note)
    }

    /// Withholds every fitted part that the record cannot hold.
    pub fn parts(&self, found: &mut Identification) {
        for term in TERMS.into_iter().filter(|t| *t != NoiseType::RateRamp) {
            let coefficient = found.model.coefficient(term);
            let mut part = Composite {
                bandwidth: found.described.model.bandwidth,
                sampling: found.described.model.sampling,
                ..Default::default()
            };
            part.terms = part.terms.with(term, coefficient);
            let at = TERMS.iter().position(|t| *t == term).unwrap_or(0);
            let [n, b, k, q, r] = found.estimates_mut_by_term();
            let Some(estimate) = [n, b, k, q, r].into_iter().nth(at) else { continue };
            let Some(value) = estimate.value else { continue };
            let least = estimate.interval95().map_or(value, |i| i.low);
            let Some(excess) = self.excess(&part, coefficient, least) else { continue };
            withhold(estimate, excess);
            found.claimed.retain(|t| *t != term);
            found.model = found.model.with(term, 0.0);
            found.supported = found.supported.with(term, 0.0);
            found.described.model = found.described.model.with(Parameter::Coefficient(term), 0.0);
            if term == NoiseType::AngleRandomWalk
                && let Some(plateau) = &mut found.white_plateau
            {
                withhold(plateau, excess);
            }
        }
        let model = &mut found.described.model;
        for (i, process) in found.markov.iter_mut().enumerate() {
            let Some(d) = model.markov.get(i).copied() else { continue };
            let part = Composite { markov: vec![d], sampling: model.sampling, ..Default::default() };
            if let Some(excess) = self.process(&part, d.rms_deg_h, &process.sigma) {
                withhold(&mut process.sigma, excess);
                withhold(&mut process.correlation_time, excess);
                *model = model.with(Parameter::MarkovSigma(i), 0.0);
            }
        }
        // The disturbances stand in the order of their size, those of the model in that of the search.
        for process in &mut found.quasi_periodic {
            let Some(rms) = process.amplitude.value else { continue };
            let nearest = model
                .quasi_periodic
                .iter()
                .enumerate()
                .min_by(|a, b| (a.1.rms_deg_h - rms).abs().total_cmp(&(b.1.rms_deg_h - rms).abs()))
                .map(|(i, d)| (i, *d));
            let Some((i, d)) = nearest else { continue };
            let part = Composite { quasi_periodic: vec![d], sampling: model.sampling, ..Default::default() };
            if let Some(excess) = self.process(&part, d.rms_deg_h, &process.amplitude) {
                let all = [&mut process.amplitude, &mut process.frequency, &mut process.coherence_time];
                all.into_iter().for_each(|e| withhold(e, excess));
                *model = model.with(Parameter::QuasiPeriodicRms(i), 0.0);
            }
        }
    }

    fn process(&self, part: &Composite, rms: f64, estimate: &Estimate) -> Option<(f64, f64)> {
        let least = estimate.interval95().map_or(rms, |i| i.low);
        if least > AMPLITUDE_ALLOWANCE * self.half_range {
            return Some((least, self.half_range));
        }
        self.excess(part, rms, least)
    }
}

/// Takes the value back and says what it was set against.
fn withhold(estimate: &mut Estimate, (has, most): (f64, f64)) {
    let mut none =
        Estimate::not_identifiable(estimate.id, &estimate.channel, None, estimate.unit, estimate.method);
    none.notes = std::mem::take(&mut estimate.notes);
    *estimate = none.note(note!("note.part_beyond_record", has, most));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::composite::{Damped, Described, Line};
    use crate::noise::digest::{DigestPlan, RateAccumulator};
    use crate::noise::identification::MarkovFound;
    use crate::noise::intervals::BoundedPoint;

    /// White values of ±1 deg/h.
    fn whole() -> Whole {
        let mut bits = 1u32;
        let values: Vec<f64> = (0..20_000)
            .map(|_| {
                bits ^= bits << 13;
                bits ^= bits >> 17;
                bits ^= bits << 5;
                f64::from(bits) / f64::from(u32::MAX) * 2.0 - 1.0
            })
            .collect();
        let mut pass = RateAccumulator::new(DigestPlan::new(1.0));
        pass.push(&values, 0, false);
        let digest = pass.finish();
        let curve = digest.deviations.curve(crate::noise::family::Estimator::Allan).unwrap();
        let octaves: Vec<BoundedPoint> = curve
            .points
            .iter()
            .map(|point| BoundedPoint {
                point: *point,
                noise: NoiseType::AngleRandomWalk,
                edf: 0.5 * digest.samples as f64 / point.m as f64,
                interval95: None,
                interval68: None,
            })
            .collect();
        Whole::of(&digest, &octaves, None)
    }

    #[test]
    fn what_is_larger_than_the_record_is_withheld() {
        let line = |amplitude_deg_h: f64, frequency_hz: f64| SpectralLine {
            frequency_hz,
            resolution_hz: 1e-3,
            amplitude_deg_h,
            excess: 9.0,
            false_alarm_probability: 0.0,
            harmonic_of: None,
            harmonic_order: 1,
            sinusoid: None,
        };
        // Too large for the range; too large for the curve at 50 s; small enough.
        let mut lines = vec![line(1.5, 0.2), line(0.9, 0.01), line(0.05, 0.2)];
        let said = whole().lines(&mut lines).unwrap();
        assert_eq!(lines.len(), 1);
        assert_eq!(said.id, "note.line_beyond_record");
        assert!(whole().lines(&mut lines).is_none());
    }

    #[test]
    fn a_process_larger_than_the_record_is_withheld_everywhere() {
        for (rms, fits) in [(0.02, true), (0.6, false)] {
            let normal = crate::estimate::Spread::Normal { standard_uncertainty: 0.05 * rms };
            let measured = |id, value| Estimate::measured(id, "rate", value, "", normal.clone(), "whittle");
            let mut found = Identification::empty("rate");
            found.markov.push(MarkovFound {
                sigma: measured("markov_sigma", rms),
                correlation_time: measured("markov_correlation_time", 60.0),
            });
            found.described = Described {
                model: Composite {
                    markov: vec![Damped { rms_deg_h: rms, frequency_hz: 0.0, decay_time_s: 60.0 }],
                    lines: vec![Line { amplitude_deg_h: 1.0, frequency_hz: 0.1 }],
                    ..Default::default()
                },
                ..Default::default()
            };
            whole().parts(&mut found);
            assert_eq!(found.markov[0].sigma.value.is_some(), fits);
            assert_eq!(found.described.model.markov[0].rms_deg_h > 0.0, fits);
        }
    }
    #[test]
    fn a_difference_that_does_no_harm_withholds_nothing() {
        let whole = whole();
        let excess = |rms_deg_h: f64| {
            let process = Damped { rms_deg_h, frequency_hz: 0.0, decay_time_s: 60.0 };
            whole.excess(&Composite { markov: vec![process], ..Default::default() }, rms_deg_h, rms_deg_h)
        };
        // The record as a whole allows a process of this size.
        let (has, most) = excess(10.0).unwrap();
        let allowed = 10.0 * most / has;
        assert_eq!(excess(1.002 * allowed), None);
        assert!(excess(1.1 * allowed).is_some());
    }
}
