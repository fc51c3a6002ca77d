//! Runs the records of a mix on all cores.

use super::alternatives::{Values, log_log, minimum, nonnegative_variances, slopes};
use super::claims::{estimate_of, false_claims, swapped};
use super::generator::Generator;
use super::mixes::{Kind, Mix, Quantity, TAU0_S};
use super::oracle::{Fit, Oracle};
use super::record::{digest, identify};
use super::tally::{Judged, METHODS, Outcome, Tally};
use super::whittle::Layout;
use super::{allan, gmwm, rivals};
use rayon::prelude::*;
use sagnac::noise::composite::Parameter;
use sagnac::noise::identification::Identification;
use sagnac::noise::model::TERMS;
use sagnac::noise::simulate::{Setup, Simulator};

/// Relative bound up to which a term counts as identifiable.
pub const IDENTIFIABLE: f64 = 0.2;
/// Longest averaging time of the usual methods, share of the record.
const LONGEST: f64 = 0.2;
/// Longest of the wavelet variances.
const LONGEST_WAVELET: f64 = 0.5;
const BIAS_DEG_H: f64 = 0.37;
/// Place of the first of the usual methods.
const FIRST_USUAL: usize = 2;

/// A record from the simulator of the program.
pub fn simulated(mix: &Mix, samples: usize, seed: u64) -> Vec<f64> {
    let setup = Setup { bias_deg_h: BIAS_DEG_H, ..Setup::for_record(seed, TAU0_S, samples as u64) };
    Simulator::of(&mix.truth, &setup).take(samples)
}

struct Study<'a> {
    mix: &'a Mix,
    quantities: &'a [Quantity],
    parameters: Vec<Parameter>,
    bounds: &'a [f64],
    layout: Layout,
    generator: Generator,
    samples: usize,
    source: Source,
}

/// Where records come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The simulator of the program.
    Simulator,
    /// The generator that shares nothing with it.
    Generator,
    /// Both, in turn.
    Both,
}

/// `records` records of a mix.
pub fn study(mix: &Mix, hours: f64, records: usize, seed: u64, source: Source) -> Tally {
    let samples = (hours * 3600.0 / TAU0_S).round() as usize;
    let layout = Layout::new(samples, &mix.truth);
    let quantities = mix.quantities();
    let parameters = mix.parameters();
    let by_parameter = layout.bounds(&mix.truth, &parameters);
    let bounds: Vec<f64> = quantities
        .iter()
        .map(|q| {
            let place = q.parameter.and_then(|p| parameters.iter().position(|x| *x == p));
            place.map_or(f64::NAN, |i| by_parameter[i])
        })
        .collect();
    let generator = Generator::new(mix, samples, TAU0_S);
    let study = Study {
        mix,
        quantities: &quantities,
        parameters,
        bounds: &bounds,
        layout,
        generator,
        samples,
        source,
    };
    let records = (0..records as u64)
        .into_par_iter()
        .map(|run| study.record(run, seed.wrapping_mul(1_000_003).wrapping_add(run)))
        .collect();
    Tally { name: mix.name, hours, bounds: bounds.clone(), quantities, records }
}

impl Study<'_> {
    fn samples_of(&self, run: u64, seed: u64) -> Vec<f64> {
        if self.source == Source::Generator || self.source == Source::Both && run % 2 == 1 {
            self.generator.record(seed, BIAS_DEG_H)
        } else {
            simulated(self.mix, self.samples, seed)
        }
    }

    fn record(&self, run: u64, seed: u64) -> Judged {
        let truth = &self.mix.truth;
        let y = self.samples_of(run, seed);
        let digest = digest(&y, TAU0_S);
        let ranged = identify(&digest);
        let found = &ranged.identification;

        let data = self.layout.data(&y);
        let oracle = Oracle { layout: &self.layout, data: &data, parameters: &self.parameters, start: truth };
        let best = oracle.fit();

        let points = allan::octaves(&y, TAU0_S, LONGEST_WAVELET);
        let within = |p: &&allan::Point| p.tau_s <= LONGEST * self.samples as f64 * TAU0_S;
        let short: Vec<allan::Point> = points.iter().filter(within).copied().collect();
        let usual = [log_log(&short), slopes(&short), minimum(&short), nonnegative_variances(&short)];
        let wavelet = gmwm::fit(&points, truth, &self.parameters);

        let outcomes = self
            .quantities
            .iter()
            .enumerate()
            .map(|(i, q)| {
                let mut outcome = self.ours(found, q);
                self.alternatives(&mut outcome, q, &usual, &wavelet);
                self.told(&mut outcome, q, self.bounds[i], &oracle, &best);
                if let Kind::Coefficient(term) = q.kind
                    && self.bounds[i] <= IDENTIFIABLE
                {
                    let fit = (&self.layout, &data, &best);
                    let record_s = self.samples as f64 * TAU0_S;
                    outcome.rise = rivals::rise(term, truth, &self.parameters, fit, record_s);
                }
                outcome
            })
            .collect();
        let swap = swapped(found, truth).map(|(other, parameters)| {
            let rival = Oracle { layout: &self.layout, data: &data, parameters: &parameters, start: &other };
            0.5 * (rival.fit().deviance - best.deviance)
        });
        Judged {
            outcomes,
            false_claims: false_claims(found, truth),
            swap,
            restricted: ranged.highest_hz.is_some() || ranged.widened > 1.0,
        }
    }

    fn ours(&self, found: &Identification, q: &Quantity) -> Outcome {
        let mut outcome = Outcome::default();
        let Some(estimate) = estimate_of(found, q, &self.mix.truth) else { return outcome };
        outcome.values[0] = estimate.value.map(|v| v / q.truth);
        outcome.values[1] = estimate.value.or(estimate.most_likely).map(|v| v / q.truth);
        outcome.interval = estimate
            .interval95()
            .map(|i| (i.low <= q.truth && q.truth <= i.high, (i.high - i.low) / q.truth.abs()));
        outcome.limit =
            estimate.upper_limit.filter(|_| estimate.value.is_none()).map(|l| q.truth.abs() <= l.value);
        outcome
    }

    fn alternatives(
        &self,
        outcome: &mut Outcome,
        q: &Quantity,
        usual: &[Values; 4],
        wavelet: &[Option<f64>],
    ) {
        if let Kind::Coefficient(term) = q.kind
            && let Some(at) = TERMS.iter().position(|t| *t == term)
        {
            for (slot, values) in outcome.values.iter_mut().skip(FIRST_USUAL).zip(usual) {
                *slot = values[at].map(|v| v / q.truth.abs());
            }
        }
        let place = q.parameter.and_then(|p| self.parameters.iter().position(|x| *x == p));
        outcome.values[METHODS.len() - 1] =
            place.and_then(|i| wavelet[i]).map(|v| q.of_parameter(v) / q.truth);
    }

    fn told(&self, outcome: &mut Outcome, q: &Quantity, bound: f64, oracle: &Oracle, best: &Fit) {
        outcome.oracle = f64::NAN;
        let Some(parameter) = q.parameter else { return };
        outcome.oracle = q.of_parameter(best.model.value(parameter)) / q.truth;
        if bound > IDENTIFIABLE {
            return;
        }
        let sigma = if parameter == super::oracle::RAMP { bound * q.truth.abs() } else { bound };
        let (a, b) = oracle.interval(best, parameter, sigma);
        let (a, b) = (q.of_parameter(a), q.of_parameter(b));
        let (low, high) = (a.min(b), a.max(b));
        outcome.oracle_interval = Some((low <= q.truth && q.truth <= high, (high - low) / q.truth.abs()));
    }
}
