//! Russian and Allan values of each channel, for `compare` and for results that are compared later.

use crate::estimate::chi_square_quantile;
use crate::measurand::allan_minimum::{FLICKER_FLOOR, lowest, readable};
use crate::measurand::russian::{DRIFT_WINDOW_S, RANDOM_WALK_WINDOW_S};
use crate::measurand::{self, GyroEvidence, russian_prediction};
use crate::noise::composite::{Composite, Parameter, Part};
use crate::noise::data::NoiseType;
use crate::noise::identifiable::hours_until_identifiable_among;
use crate::noise::null_ratio::null_ratio;
use crate::noise::russian::{null_minimum, octave_identity};
use crate::record::{
    CoherentLine, ComparisonRecord, FloorRecord, MinimumRecord, ModelRecord, OctaveRecord, OctavesRecord,
    ParameterRecord, ShareRecord, WindowRecord,
};

/// The record of a channel; `None` when the record is too short for two windows of 100 s.
pub fn record(gyro: &GyroEvidence) -> Option<ComparisonRecord> {
    gyro.windows(DRIFT_WINDOW_S)?;
    Some(ComparisonRecord {
        channel: gyro.channel.clone(),
        length_s: gyro.usable_s(),
        sample_interval_s: gyro.tau0_s,
        detrend: "mean".into(),
        windows: [DRIFT_WINDOW_S, RANDOM_WALK_WINDOW_S].into_iter().filter_map(|w| window(gyro, w)).collect(),
        octaves: octaves(gyro),
        minimum: minimum(gyro),
        floor: floor(gyro),
        model: model(gyro),
    })
}

fn window(gyro: &GyroEvidence, window_s: f64) -> Option<WindowRecord> {
    let w = gyro.windows(window_s)?;
    let predicted = russian_prediction::predicted(gyro, window_s);
    let prediction = predicted.as_ref().map(|(p, _)| p);
    let ratio = prediction.and_then(|p| p.ratio(w.standard_deviation, 0.95));
    Some(WindowRecord {
        window_s,
        exact_s: w.samples as f64 * gyro.tau0_s,
        n: w.n,
        observed: w.standard_deviation,
        predicted: prediction.map(|p| p.sigma),
        predicted_interval: predicted.as_ref().and_then(|(p, spread)| spread.interval(p.sigma, 0.95)),
        ratio: ratio.map(|r| r.0),
        ratio_interval: ratio.map(|r| r.1),
        agreement: prediction.and_then(|p| p.agreement(w.standard_deviation)),
        shares: prediction.map_or_else(Vec::new, |p| {
            let share = |s: &crate::noise::prediction::Share| ShareRecord {
                part: s.part.id().to_owned(),
                index: index(s.part),
                share: s.share,
                deviation_deg_h: p.sigma * s.share.max(0.0).sqrt(),
            };
            p.shares.iter().map(share).collect()
        }),
    })
}

fn index(part: Part) -> usize {
    match part {
        Part::Term(_) => 0,
        Part::Markov(i) | Part::QuasiPeriodic(i) | Part::Line(i) => i,
    }
}

fn octaves(gyro: &GyroEvidence) -> Option<OctavesRecord> {
    let w = gyro.windows(DRIFT_WINDOW_S)?;
    let tau_s = w.samples as f64 * gyro.tau0_s;
    let identity = octave_identity(w.means.as_deref()?, tau_s)?;
    let model = &gyro.identification.described.model;
    let expected: Vec<f64> =
        identity.octaves.iter().map(|o| model.allan_variance(o.tau_s, gyro.tau0_s)).collect();
    let whole: f64 = expected.iter().sum();
    let octaves = identity.octaves.iter().zip(expected).map(|(o, e)| OctaveRecord {
        tau_s: o.tau_s,
        deviation_deg_h: o.allan_variance.sqrt(),
        share: o.share,
        expected_share: (whole > 0.0).then_some(e / whole),
    });
    Some(OctavesRecord {
        windows: identity.windows as u64,
        of: w.n,
        sigma: identity.sigma,
        octaves: octaves.collect(),
    })
}

fn minimum(gyro: &GyroEvidence) -> Option<MinimumRecord> {
    let low = lowest(gyro)?;
    let taus_s: Vec<f64> = readable(gyro).iter().map(|p| p.point.m as f64 * gyro.tau0_s).collect();
    let largest_tau_s = *taus_s.last()?;
    let w = gyro.windows(DRIFT_WINDOW_S)?;
    // The ratio of the null depends on the record and the rule alone: N cancels.
    let window_s = w.samples as f64 * gyro.tau0_s;
    let null = null_ratio(gyro.usable_s(), window_s, &taus_s).or_else(|| {
        null_minimum(1.0, gyro.usable_s(), largest_tau_s, window_s)
            .map(|null| scattered(null.ratio, w.n.saturating_sub(1).max(1) as f64))
    });
    Some(MinimumRecord {
        deviation_deg_h: low.point.deviation,
        tau_s: low.point.m as f64 * gyro.tau0_s,
        edf: low.edf,
        largest_tau_s,
        ratio: gyro.drift_100s().map(|s| s / low.point.deviation),
        null_ratio: null,
    })
}

/// Quantiles of a ratio whose numerator is a standard deviation with so many degrees of freedom: its own scatter adds to
/// that of the minimum, in the logarithm as squares.
fn scattered([low, median, high]: [f64; 3], dof: f64) -> [f64; 3] {
    let of = |p: f64| (0.5 * (chi_square_quantile(p, dof) / dof).ln()).abs();
    [
        median * (-((median / low).ln().hypot(of(0.05)))).exp(),
        median,
        median * (high / median).ln().hypot(of(0.95)).exp(),
    ]
}

fn floor(gyro: &GyroEvidence) -> Option<FloorRecord> {
    let found = &gyro.identification;
    let n = found.angle_random_walk.value?;
    let (b, is_limit) = match (found.bias_instability.value, found.bias_instability.upper_limit) {
        (Some(b), _) => (b, false),
        (None, Some(limit)) => (limit.value, true),
        (None, None) => return None,
    };
    if b <= 0.0 {
        return None;
    }
    let mut model = found.described.model.without_ramp().without_lines();
    (model.terms.n, model.terms.b) = (n, b);
    let flicker = Parameter::Coefficient(NoiseType::Flicker);
    let own = [Parameter::Coefficient(NoiseType::AngleRandomWalk), flicker];
    let beside = found.described.parameters.iter().filter(|p| model.value(**p) > 0.0 && !own.contains(p));
    let parameters: Vec<Parameter> = own.iter().chain(beside).copied().collect();
    Some(FloorRecord {
        b_deg_h: b,
        is_limit,
        crossover_s: 3600.0 * (n / (FLICKER_FLOOR * b)).powi(2),
        identifiable_h: hours_until_identifiable_among(flicker, &model, &parameters, gyro.tau0_s),
    })
}

fn model(gyro: &GyroEvidence) -> ModelRecord {
    let described = &gyro.identification.described;
    let misfit = &gyro.identification.misfit;
    let finite = |v: f64| Some(v).filter(|v| v.is_finite());
    ModelRecord {
        parameters: described.parameters.iter().map(|p| parameter(*p, &described.model)).collect(),
        covariance: if described.covariance.iter().flatten().all(|c| c.is_finite()) {
            described.covariance.clone()
        } else {
            vec![]
        },
        misfit: finite(misfit.per_dof),
        misfit_probability: finite(misfit.probability),
        lines: described
            .model
            .lines
            .iter()
            .map(|l| CoherentLine::from((l.amplitude_deg_h, l.frequency_hz)))
            .collect(),
    }
}

fn parameter(p: Parameter, model: &Composite) -> ParameterRecord {
    let (quantity, index) = match p {
        Parameter::Coefficient(NoiseType::AngleRandomWalk) => (&measurand::ANGLE_RANDOM_WALK, 0),
        Parameter::Coefficient(NoiseType::Flicker) => (&measurand::BIAS_INSTABILITY, 0),
        Parameter::Coefficient(NoiseType::RateRandomWalk) => (&measurand::RATE_RANDOM_WALK, 0),
        Parameter::Coefficient(NoiseType::Quantization) => (&measurand::QUANTIZATION, 0),
        Parameter::Coefficient(NoiseType::RateRamp) => (&measurand::RATE_RAMP, 0),
        Parameter::MarkovSigma(i) => (&measurand::MARKOV_SIGMA, i),
        Parameter::MarkovTime(i) => (&measurand::MARKOV_CORRELATION_TIME, i),
        Parameter::QuasiPeriodicRms(i) => (&measurand::QUASI_PERIODIC_AMPLITUDE, i),
        Parameter::QuasiPeriodicFrequency(i) => (&measurand::QUASI_PERIODIC_FREQUENCY, i),
        // The coherence time of the contract is that of the line: the decay time of the autocovariance.
        Parameter::QuasiPeriodicTime(i) => (&measurand::QUASI_PERIODIC_COHERENCE_TIME, i),
        Parameter::LineAmplitude(i) => (&measurand::LINE_AMPLITUDE, i),
        Parameter::FilterTime => {
            return ParameterRecord {
                id: "filter_time".into(),
                index: 0,
                value: model.value(p),
                unit: "s".into(),
            };
        }
    };
    ParameterRecord { id: quantity.id.into(), index, value: model.value(p), unit: quantity.unit.into() }
}
