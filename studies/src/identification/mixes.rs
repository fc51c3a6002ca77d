//! The mixes of noise that are studied, with sizes near those of real fibre-optic gyros.

use sagnac::noise::composite::{Bandwidth, Composite, Damped, Parameter};
use sagnac::noise::data::NoiseType;
use sagnac::noise::model::{NoiseModel, TERMS};

/// Sample interval of every record, s.
pub const TAU0_S: f64 = 1.0;

/// A mix of noise.
pub struct Mix {
    /// Its terms in short.
    pub name: &'static str,
    /// What it is made of.
    pub truth: Composite,
}

/// What is asked for a term of a mix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// N, B, K, Q or R.
    Coefficient(NoiseType),
    /// Standard deviation of a Markov process.
    MarkovSigma,
    /// Its correlation time.
    MarkovTime,
    /// Standard deviation of a quasi-periodic process.
    PeriodicRms,
    /// Its frequency.
    PeriodicFrequency,
    /// Its coherence time.
    PeriodicTime,
    /// Cut-off frequency of a filter.
    Cutoff,
}

/// One number that a mix has and an identification should give.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// What it is.
    pub kind: Kind,
    /// Its symbol.
    pub label: &'static str,
    /// Its true value.
    pub truth: f64,
    /// The continuous parameter behind it; a moving average has none.
    pub parameter: Option<Parameter>,
}

impl Quantity {
    /// A value or bound of the parameter as a value or bound of this quantity.
    pub fn of_parameter(&self, value: f64) -> f64 {
        if self.kind == Kind::Cutoff { 1.0 / (2.0 * std::f64::consts::PI * value) } else { value }
    }
}

/// Symbol of a term.
pub fn label(term: NoiseType) -> &'static str {
    match term {
        NoiseType::AngleRandomWalk => "N",
        NoiseType::Flicker => "B",
        NoiseType::RateRandomWalk => "K",
        NoiseType::Quantization => "Q",
        NoiseType::RateRamp => "R",
    }
}

impl Mix {
    /// What an identification should give.
    pub fn quantities(&self) -> Vec<Quantity> {
        let truth = &self.truth;
        let of = |kind, label, parameter: Parameter| Quantity {
            kind,
            label,
            truth: truth.value(parameter),
            parameter: Some(parameter),
        };
        let mut out: Vec<Quantity> = TERMS
            .into_iter()
            .filter(|t| truth.terms.coefficient(*t) != 0.0)
            .map(|t| of(Kind::Coefficient(t), label(t), Parameter::Coefficient(t)))
            .collect();
        if !truth.markov.is_empty() {
            out.push(of(Kind::MarkovSigma, "σ_m", Parameter::MarkovSigma(0)));
            out.push(of(Kind::MarkovTime, "T_c", Parameter::MarkovTime(0)));
        }
        if !truth.quasi_periodic.is_empty() {
            out.push(of(Kind::PeriodicRms, "σ_p", Parameter::QuasiPeriodicRms(0)));
            out.push(of(Kind::PeriodicFrequency, "f_p", Parameter::QuasiPeriodicFrequency(0)));
            out.push(of(Kind::PeriodicTime, "T_p", Parameter::QuasiPeriodicTime(0)));
        }
        if let Some(filter) = &truth.bandwidth {
            let parameter = matches!(filter, Bandwidth::FirstOrder { .. }).then_some(Parameter::FilterTime);
            out.push(Quantity {
                kind: Kind::Cutoff,
                label: "f_c",
                truth: filter.cutoff_hz(TAU0_S),
                parameter,
            });
        }
        out
    }

    /// The continuous parameters of the true structure.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.quantities().iter().filter_map(|q| q.parameter).collect()
    }
}

fn terms(n: f64, b: f64, k: f64, r: f64, q: f64) -> Composite {
    NoiseModel { n, b, k, r, q }.into()
}

fn markov(rms_deg_h: f64, decay_time_s: f64) -> Vec<Damped> {
    vec![Damped { rms_deg_h, frequency_hz: 0.0, decay_time_s }]
}

/// The excess near 10 s that the founding paper's figures imply, at a share of the noise amplitude.
fn periodic(rms_deg_h: f64) -> Vec<Damped> {
    vec![Damped { rms_deg_h, frequency_hz: 0.08, decay_time_s: 60.0 }]
}

/// Standard deviation of samples of white noise.
fn sample_sigma(n: f64) -> f64 {
    60.0 * n / TAU0_S.sqrt()
}

/// Every mix.
pub fn mixes() -> Vec<Mix> {
    let short = markov(0.1, 1.5 * TAU0_S);
    let noise = sample_sigma(0.0023);
    let with_short = (noise.powi(2) + short[0].mean_variance(TAU0_S)).sqrt();
    // Bias instability of the published tables is the Allan floor.
    let device = |n, floor: f64| terms(n, floor / 0.664, 0.0, 0.0, 0.0);
    let n = || terms(0.0023, 0.0, 0.0, 0.0, 0.0);
    let list = [
        ("N", n()),
        ("N+B", terms(0.002, 0.006, 0.0, 0.0, 0.0)),
        ("N+K", terms(0.0023, 0.0, 0.02, 0.0, 0.0)),
        ("N+B+K", terms(0.002, 0.006, 0.01, 0.0, 0.0)),
        ("K, small N", terms(0.0002, 0.0, 0.05, 0.0, 0.0)),
        ("N+Q", terms(0.0023, 0.0, 0.0, 0.0, 0.05)),
        ("N+R", terms(0.0023, 0.0, 0.0, 0.003, 0.0)),
        ("N+B+R", terms(0.002, 0.006, 0.0, 0.01, 0.0)),
        ("N+short Markov", Composite { markov: short.clone(), ..n() }),
        ("N+B+short Markov", Composite { markov: short.clone(), ..terms(0.0023, 0.007, 0.0, 0.0, 0.0) }),
        ("N+long Markov", Composite { markov: markov(0.01, 600.0), ..n() }),
        ("N+quasi-periodic", Composite { quasi_periodic: periodic(0.58 * noise), ..n() }),
        (
            "N+short Markov+quasi-periodic",
            Composite { markov: short, quasi_periodic: periodic(0.58 * with_short), ..n() },
        ),
        (
            "N+B first-order filter",
            Composite {
                bandwidth: Some(Bandwidth::FirstOrder { time_constant_s: 2.0 }),
                ..terms(0.002, 0.006, 0.0, 0.0, 0.0)
            },
        ),
        ("N moving average", Composite { bandwidth: Some(Bandwidth::MovingAverage { samples: 4 }), ..n() }),
        ("OIUS-200 N+B", device(0.0081, 0.006)),
        ("TIUS-500 N+B", device(0.0068, 0.0025)),
        ("OIUS-501 N+B", device(0.0023, 0.0011)),
        ("OIUS-1000 N+B", device(0.00055, 0.0006)),
        ("OIUS-2000 N+B", device(0.00025, 0.00024)),
    ];
    list.into_iter().map(|(name, truth)| Mix { name, truth }).collect()
}
