//! What an identification claims, set against what is true.

use super::mixes::{Kind, Quantity, TAU0_S, label};
use sagnac::estimate::Estimate;
use sagnac::noise::composite::{Bandwidth, Composite, Parameter};
use sagnac::noise::data::NoiseType;
use sagnac::noise::identification::Identification;

/// Estimates come in the order of the contract.
const ORDER: [NoiseType; 5] = [
    NoiseType::AngleRandomWalk,
    NoiseType::Flicker,
    NoiseType::RateRandomWalk,
    NoiseType::RateRamp,
    NoiseType::Quantization,
];

/// The claim whose time or frequency lies nearest to the truth.
fn nearest<T>(claims: &[T], truth: f64, of: impl Fn(&T) -> Option<f64>) -> Option<&T> {
    let distance = |c: &T| of(c).map_or(f64::INFINITY, |v| (v / truth).ln().abs());
    claims.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// What an identification says about a quantity of the mix.
pub fn estimate_of<'a>(
    found: &'a Identification,
    quantity: &Quantity,
    truth: &Composite,
) -> Option<&'a Estimate> {
    let markov = || nearest(&found.markov, truth.markov.first()?.decay_time_s, |m| m.correlation_time.value);
    let periodic =
        || nearest(&found.quasi_periodic, truth.quasi_periodic.first()?.frequency_hz, |p| p.frequency.value);
    match quantity.kind {
        Kind::Coefficient(term) => ORDER.iter().position(|t| *t == term).map(|i| found.estimates()[i]),
        Kind::MarkovSigma => markov().map(|m| &m.sigma),
        Kind::MarkovTime => markov().map(|m| &m.correlation_time),
        Kind::PeriodicRms => periodic().map(|p| &p.amplitude),
        Kind::PeriodicFrequency => periodic().map(|p| &p.frequency),
        Kind::PeriodicTime => periodic().map(|p| &p.coherence_time),
        Kind::Cutoff => found.cutoff.as_ref(),
    }
}

/// Absent terms that are claimed.
pub fn false_claims(found: &Identification, truth: &Composite) -> Vec<&'static str> {
    let mut out: Vec<&'static str> = ORDER
        .into_iter()
        .zip(found.estimates())
        .filter(|(t, e)| e.value.is_some() && truth.terms.coefficient(*t) == 0.0)
        .map(|(t, _)| label(t))
        .collect();
    out.extend(vec!["Markov"; found.markov.len().saturating_sub(truth.markov.len())]);
    out.extend(vec!["quasi-periodic"; found.quasi_periodic.len().saturating_sub(truth.quasi_periodic.len())]);
    if found.cutoff.as_ref().is_some_and(|c| c.value.is_some()) && truth.bandwidth.is_none() {
        out.push("filter");
    }
    out
}

/// Where a filter was taken for a short Markov process or the other way round: the structure that was claimed, near the
/// truth, and its parameters. The two differ by where the white part is seen.
pub fn swapped(found: &Identification, truth: &Composite) -> Option<(Composite, Vec<Parameter>)> {
    let filter = found.cutoff.as_ref().is_some_and(|c| c.value.is_some());
    let mut other = truth.clone();
    let markov = truth.markov.first();
    if let Some(process) = markov
        && filter
        && found.markov.is_empty()
    {
        other.markov.clear();
        other.terms.n = truth.terms.n.hypot(process.white_equivalent_deg_rt_h());
        let share = (process.white_equivalent_deg_rt_h() / other.terms.n).powi(2);
        other.bandwidth = Some(Bandwidth::FirstOrder {
            time_constant_s: (share * process.decay_time_s).max(0.05 * TAU0_S),
        });
    } else if let (Some(Bandwidth::FirstOrder { time_constant_s }), false, false) =
        (truth.bandwidth, filter, found.markov.is_empty())
    {
        // White noise behind the filter is a Markov process; what is left unfiltered starts small.
        other.bandwidth = None;
        other.markov = vec![sagnac::noise::composite::Damped {
            rms_deg_h: truth.terms.n * (3600.0 / (2.0 * time_constant_s)).sqrt(),
            frequency_hz: 0.0,
            decay_time_s: time_constant_s,
        }];
        other.terms.n *= 0.05;
    } else {
        return None;
    }
    let mut parameters: Vec<Parameter> = sagnac::noise::model::TERMS
        .into_iter()
        .filter(|t| other.terms.coefficient(*t) != 0.0)
        .map(Parameter::Coefficient)
        .collect();
    if !other.markov.is_empty() {
        parameters.extend([Parameter::MarkovSigma(0), Parameter::MarkovTime(0)]);
    }
    if !other.quasi_periodic.is_empty() {
        parameters.extend([
            Parameter::QuasiPeriodicRms(0),
            Parameter::QuasiPeriodicFrequency(0),
            Parameter::QuasiPeriodicTime(0),
        ]);
    }
    if other.bandwidth.is_some() {
        parameters.push(Parameter::FilterTime);
    }
    Some((other, parameters))
}
