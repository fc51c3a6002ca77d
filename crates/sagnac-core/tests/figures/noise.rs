//! A gyro at rest: records with known noise of every kind, what one pass leaves of them, and what is identified.

use crate::stored::Figures;
use sagnac_core::measurand::GyroEvidence;
use sagnac_core::noise::autocorrelation;
use sagnac_core::noise::composite::{Bandwidth, Composite, Damped, Described, Line, Parameter, Sampling};
use sagnac_core::noise::data::NoiseType;
use sagnac_core::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use sagnac_core::noise::expected::{bias_power, decision_power, deviation_power, expected_upper_limit};
use sagnac_core::noise::family::{Estimator, non_overlapping};
use sagnac_core::noise::identifiable::{
    hours_until_identifiable, hours_until_identifiable_among, relative_bound,
};
use sagnac_core::noise::intervals::bounded;
use sagnac_core::noise::model::{NoiseModel, TERMS};
use sagnac_core::noise::motion::{motion, scatter};
use sagnac_core::noise::null_ratio::null_ratio;
use sagnac_core::noise::prediction::{WindowPrediction, covariance_of, unseen_variance};
use sagnac_core::noise::residual::whitened;
use sagnac_core::noise::russian;
use sagnac_core::noise::simulate::{Setup, Simulator};
use sagnac_core::noise::slope::{self, SlopePoint};
use sagnac_core::noise::spectral_record::SpectralRecord;
use sagnac_core::noise::static_bias::{BiasUncertainty, Orientation, Uncertain, earth_rate};
use sagnac_core::noise::tau_grid::TauGrid;

/// A unit, its sampling and the length of its record.
pub struct Unit {
    pub name: &'static str,
    noise: Composite,
    pub tau0_s: f64,
    samples: usize,
    /// Samples that are missing behind the middle of the record.
    gap: usize,
    /// Step of a rounded output, deg/h.
    step_deg_h: Option<f64>,
}

fn terms(n: f64, b: f64, k: f64, q: f64, r: f64) -> Composite {
    Composite::from(NoiseModel { n, b, k, q, r })
}

fn damped(rms_deg_h: f64, frequency_hz: f64, decay_time_s: f64) -> Damped {
    Damped { rms_deg_h, frequency_hz, decay_time_s }
}

/// Units that between them have every kind of noise that is identified.
pub fn units() -> Vec<Unit> {
    let unit = |name, tau0_s, samples, noise| Unit { name, noise, tau0_s, samples, gap: 0, step_deg_h: None };
    let plain = terms(0.003, 0.02, 0.03, 0.0, 0.0);
    let lines = [(0.05, 0.21), (0.03, 0.42), (0.02, 1.3)];
    let line = |(amplitude_deg_h, frequency_hz)| Line { amplitude_deg_h, frequency_hz };
    vec![
        unit("plain", 0.5, 24_000, plain.clone()),
        unit("white", 1.0, 6_000, terms(0.01, 0.0, 0.0, 0.0, 0.0)),
        unit("quantised ramp", 0.1, 30_000, terms(0.004, 0.0, 0.0, 0.05, 0.3)),
        Unit { gap: 700, ..unit("walk with a gap", 1.0, 12_000, terms(0.002, 0.0, 0.2, 0.0, 0.0)) },
        unit("lines", 0.2, 24_000, Composite { lines: lines.map(line).to_vec(), ..plain.clone() }),
        unit("markov", 0.5, 24_000, Composite { markov: vec![damped(0.3, 0.0, 40.0)], ..plain.clone() }),
        unit(
            "disturbance",
            0.2,
            30_000,
            Composite { quasi_periodic: vec![damped(0.1, 0.6, 30.0)], ..plain.clone() },
        ),
        unit(
            "filtered",
            0.1,
            24_000,
            Composite { bandwidth: Some(Bandwidth::FirstOrder { time_constant_s: 0.4 }), ..plain.clone() },
        ),
        unit(
            "moving average",
            0.1,
            24_000,
            Composite { bandwidth: Some(Bandwidth::MovingAverage { samples: 5 }), ..plain.clone() },
        ),
        Unit { step_deg_h: Some(0.5), ..unit("rounded", 0.5, 16_000, terms(0.004, 0.03, 0.0, 0.0, 0.0)) },
    ]
}

impl Unit {
    fn record(&self) -> Vec<f64> {
        let setup = Setup { bias_deg_h: 1.5, ..Setup::for_record(17, self.tau0_s, self.samples as u64) };
        let values = Simulator::of(&self.noise, &setup).take(self.samples);
        let rounded = |step: f64| values.iter().map(|v| (v / step).round() * step).collect();
        self.step_deg_h.map_or_else(|| values.clone(), rounded)
    }

    pub fn digest(&self) -> RateDigest {
        let plan = DigestPlan {
            estimators: Estimator::ALL.to_vec(),
            taus: TauGrid::Decade,
            ..DigestPlan::new(self.tau0_s)
        };
        let record = self.record();
        let (early, late) = record.split_at(if self.gap > 0 { self.samples / 2 } else { 5000 });
        let mut pass = RateAccumulator::new(plan);
        pass.push(early, 0, false);
        pass.push(late, (early.len() + self.gap) as u64, self.gap == 0);
        pass.finish()
    }

    pub fn evidence(&self) -> GyroEvidence {
        GyroEvidence::identify("g".into(), self.digest(), self.tau0_s, 0.01, self.step_deg_h)
    }
}

/// What one pass leaves of the samples.
#[test]
fn digests() {
    let mut figures = Figures::default();
    for unit in units() {
        let digest = unit.digest();
        let name = unit.name;
        figures.add(format!("{name} samples"), &(digest.samples, digest.mean, digest.min, digest.max));
        figures.add(format!("{name} deviations"), &digest.deviations);
        figures.add(format!("{name} octaves"), &digest.octaves);
        figures.add(format!("{name} spectrum"), &digest.welch);
        figures.add(format!("{name} blocks"), &digest.blocks);
        figures.add(format!("{name} windows"), &digest.windows);
        figures.add(format!("{name} histogram"), &digest.histogram);
        figures.add(format!("{name} envelope"), &(&digest.envelope, digest.quietest_deg_h));
        let motion = motion(&digest.blocks, unit.tau0_s, digest.quietest_deg_h, 1.0);
        figures.add(format!("{name} motion"), &(motion, scatter(&digest.blocks.mean)));
        let correlation = autocorrelation::of_series(&digest.blocks.mean[..2000], 12);
        let box_test = correlation.as_ref().map(|c| c.ljung_box(10));
        let spectral = autocorrelation::of_spectrum(&digest.welch.spectrum, 12);
        figures.add(format!("{name} correlation"), &(correlation, box_test, spectral));
    }
    figures.check("digests.txt");
}

/// What is identified, and that it holds the unit that the record was made from.
#[test]
fn identification() {
    let mut figures = Figures::default();
    for unit in units() {
        let name = unit.name;
        let found = unit.evidence();
        let noise = &found.identification;
        for estimate in noise.estimates() {
            figures.add(format!("{name} {}", estimate.id), estimate);
        }
        figures.add(format!("{name} plateau"), &(&noise.white_plateau, &noise.plateau));
        figures.add(format!("{name} models"), &(noise.model, noise.supported, noise.full, &noise.allowed));
        figures.add(
            format!("{name} claims"),
            &(&noise.claimed, noise.ambiguous, noise.likelihood_ratios, noise.highest_hz, &noise.misfit),
        );
        figures.add(format!("{name} description"), &(&noise.described, noise.covariance));
        figures.add(format!("{name} processes"), &(&noise.markov, &noise.quasi_periodic, &noise.cutoff));
        figures.add(format!("{name} lines"), &(&found.lines, &found.withheld_line));
        figures.add(format!("{name} points"), &(&found.sigma_tau, &found.octaves));
        figures.add(format!("{name} fit"), &found.goodness);
        let record = SpectralRecord::of_digest(&found.digest, &found.lines, unit.tau0_s);
        figures.add(format!("{name} whitened"), &whitened(&record, &noise.described.model));
        let windows = [10.0, 100.0, 1000.0].map(|w| {
            let count = (unit.samples as f64 * unit.tau0_s / w) as u64;
            let told = WindowPrediction::of(&noise.described, w, count, unit.tau0_s);
            let against = told.as_ref().map(|p| (p.ratio(0.05, 0.95), p.agreement(0.05), p.known_dof()));
            (told, against)
        });
        figures.add(format!("{name} windows"), &windows);
        let bias = BiasUncertainty::of_mean(&noise.allowed, 5000.0, None, &[("table", 0.01)]);
        figures.add(format!("{name} bias"), &(bias.variance(), bias.standard(), bias));

        // The record was made with a known N, and rounding adds its own: both together are what is claimed.
        let rounding = unit.step_deg_h.unwrap_or(0.0).powi(2) / 12.0 * unit.tau0_s / 3600.0;
        let made = (unit.noise.terms.n.powi(2) + rounding).sqrt();
        let n = noise.read_angle_random_walk();
        if let (Some(value), Some(interval)) = (n.value, n.interval95()) {
            let half = 0.5 * (interval.high - interval.low);
            assert!((value - made).abs() < 2.0 * half, "{name}: {value} of {made} in {interval:?}");
        }
        assert_eq!(noise.markov.len(), unit.noise.markov.len(), "{name}");
        assert_eq!(noise.quasi_periodic.len(), unit.noise.quasi_periodic.len(), "{name}");
    }
    figures.check("identification.txt");
}

/// Closed forms of every part of a model.
#[test]
fn models() {
    let mut figures = Figures::default();
    let taus = [0.1, 0.7, 5.0, 60.0, 900.0];
    let hz = [1e-4, 3e-3, 0.08, 0.6, 2.1, 4.9];
    for unit in units() {
        for sampling in [Sampling::Averaging, Sampling::Instantaneous] {
            let model = Composite { sampling, ..unit.noise.clone() };
            for part in model.parts() {
                let name = format!("{} {} {sampling:?}", unit.name, part.id());
                let at = |f: &dyn Fn(f64) -> f64| taus.map(f);
                let variances = (
                    at(&|t| model.part_allan_variance(part, t, 0.1)),
                    at(&|t| model.part_mean_variance(part, t, 0.1)),
                    taus.map(|t| model.part_expected_variance(part, t, 9, 0.1)),
                );
                figures.add(name, &(hz.map(|f| model.part_density(part, f, 0.1)), variances));
            }
            let dominant = taus.map(|t| model.dominant(t, 0.1));
            let totals = (hz.map(|f| model.density(f, 0.1)), taus.map(|t| model.allan_variance(t, 0.1)));
            figures.add(format!("{} whole {sampling:?}", unit.name), &(dominant, totals));
        }
    }
    for (name, d) in [("markov", damped(0.3, 0.0, 4.0)), ("disturbance", damped(0.1, 0.6, 30.0))] {
        for sampling in [Sampling::Averaging, Sampling::Instantaneous] {
            let modes = [0, 1, 2, 7, 100, 255].map(|k| d.mode_power(k, 256, 0.5, sampling));
            let windowed = d.windowed(128, 0.5, sampling);
            let windowed = hz.map(|f| windowed.density(f));
            let densities = hz.map(|f| d.density(f, 0.5, sampling));
            figures.add(format!("{name} {sampling:?}"), &(modes, windowed, densities, d.rate()));
        }
        let variances = (taus.map(|t| d.mean_variance(t)), taus.map(|t| d.allan_variance(t)));
        figures.add(format!("{name} variances"), &(variances, d.white_equivalent_deg_rt_h()));
    }
    let filters = [Bandwidth::FirstOrder { time_constant_s: 0.3 }, Bandwidth::MovingAverage { samples: 7 }];
    for filter in filters {
        let densities = TERMS.map(|t| hz.map(|f| filter.unit_density(t, f, 0.1, Sampling::Averaging)));
        let white = taus.map(|t| filter.unit_white_mean_variance(t, 0.1));
        figures.add(format!("{filter:?}"), &(filter.cutoff_hz(0.1), densities, white));
    }
    figures.check("models.txt");
}

fn described() -> Described {
    let model = Composite { markov: vec![damped(0.3, 0.0, 40.0)], ..terms(0.003, 0.02, 0.03, 0.01, 0.1) };
    let parameters = vec![
        Parameter::Coefficient(NoiseType::AngleRandomWalk),
        Parameter::Coefficient(NoiseType::Flicker),
        Parameter::MarkovSigma(0),
        Parameter::MarkovTime(0),
    ];
    let covariance =
        (0..4).map(|i| (0..4).map(|j| if i == j { [1e-8, 4e-6, 9e-4, 25.0][i] } else { 0.0 }).collect());
    Described { model, parameters, covariance: covariance.collect() }
}

/// What a record can show before it is made, and what is predicted from a model.
#[test]
fn expectations() {
    let mut figures = Figures::default();
    let model = NoiseModel { n: 0.003, b: 0.02, k: 0.03, q: 0.02, r: 0.1 };
    for term in TERMS {
        let power = decision_power(term, 0.02, &model, 20_000, 1.0, 0.05);
        let limit = expected_upper_limit(term, &model.with(term, 0.0), 20_000, 1.0);
        figures.add(format!("power {}", term.id()), &(power, limit));
        let bounds = [1.0, 10.0, 100.0].map(|h| relative_bound(term, &model, h, 1.0));
        figures.add(format!("bound {}", term.id()), &(bounds, hours_until_identifiable(term, &model, 1.0)));
        figures.add(format!("unseen {}", term.id()), &unseen_variance(term, 0.02, 100.0, 36));
        let windows = [10.0, 100.0].map(|t| russian::unit_expected_variance(term, t, 36));
        figures.add(format!("windows {}", term.id()), &windows);
        let readings = (slope::slope(term), slope::reading_time_s(term));
        let points: Vec<SlopePoint> = (0..9)
            .map(|i| {
                let tau_s = 0.5 * 2f64.powi(i);
                let bend = 1.0 + 0.01 * f64::from(i % 3);
                SlopePoint { tau_s, deviation: bend * tau_s.powf(slope::slope(term)), edf: 900.0 / tau_s }
            })
            .collect();
        let read =
            (slope::runs(&points, term), slope::through(&points[2..5], term), slope::read(&points, term));
        figures.add(format!("slope {}", term.id()), &(readings, read));
    }
    let described = described();
    for window in [10.0, 100.0, 700.0] {
        let told = WindowPrediction::of(&described, window, 30, 0.5);
        let against = told.as_ref().map(|p| {
            let at = |s: f64| (p.ratio(s, 0.95), p.agreement(s));
            ([0.01, 0.05, 0.12, 0.3, 2.0].map(at), p.known_dof())
        });
        figures.add(format!("prediction {window}"), &(told, against));
    }
    let wanted = [Parameter::Coefficient(NoiseType::AngleRandomWalk), Parameter::MarkovTime(0)];
    let hours =
        wanted.map(|w| hours_until_identifiable_among(w, &described.model, &described.parameters, 1.0));
    figures.add("hours among", &hours);
    figures.add("propagated", &described.propagate(|m| m.allan_variance(100.0, 0.5).sqrt()));
    // A quantity with itself has its variance, and with its negative the same with the other sign.
    let deviation = |m: &Composite| m.allan_variance(100.0, 0.5).sqrt();
    let variance = described.propagate(deviation).standard_uncertainty.powi(2);
    for (sign, size) in [(1.0, 0.05), (-1.0, 0.2)] {
        let other = |m: &Composite| sign * deviation(m);
        let together = covariance_of(&described, (deviation, 0.05), (other, size));
        assert!((together - sign * variance).abs() < 1e-3 * variance, "{together} of {variance}");
        figures.add(format!("covariance {sign}"), &together);
    }
    figures.add("russian", &(russian::predict(&model, 100.0, 36), russian::angle_random_walk_from_10s(0.2)));
    let covariance = [[1e-8; 5]; 5];
    figures.add("russian uncertainty", &russian::prediction_uncertainty(&model, &covariance, 100.0, 36));
    figures.add("russian minimum", &russian::null_minimum(0.01, 7200.0, 2000.0, 100.0));
    let means: Vec<f64> = (0..41).map(|i| f64::from(i * i % 23)).collect();
    figures.add("russian octaves", &russian::octave_identity(&means, 100.0));
    figures.add("null ratio", &null_ratio(7200.0, 100.0, &[10.0, 20.0, 40.0, 80.0, 160.0, 320.0]));
    figures.add("deviation power", &deviation_power(|h| 12.0 * h, 3.0, 0.05));
    figures.add("bias power", &bias_power(0.1, |h| 0.05 / h.sqrt(), 2.0, 0.05));
    let uncertain = |value, uncertainty| Uncertain { value, uncertainty };
    for heading in [0.0, 37.0, 90.0] {
        let orientation = Orientation {
            latitude_deg: uncertain(56.0, 0.01),
            heading_deg: uncertain(heading, 0.2),
            elevation_deg: uncertain(12.0, 0.1),
        };
        figures.add(format!("earth {heading}"), &earth_rate(&orientation));
    }
    figures.check("expectations.txt");
}

/// Intervals of every estimator over every noise, with gaps in the record and without.
#[test]
fn intervals() {
    let mut figures = Figures::default();
    for unit in units().into_iter().take(4) {
        let digest = unit.digest();
        for estimator in Estimator::ALL {
            let Some(curve) = digest.deviations.curve(*estimator) else { continue };
            for term in TERMS {
                let of = |p: &_| bounded(*estimator, p, &curve.stretches, term);
                let list: Vec<_> = curve.points.iter().map(of).collect();
                figures.add(format!("{} {} {}", unit.name, estimator.id(), term.id()), &list);
            }
        }
        let record = unit.record();
        let blocks = [1, 3, 50].map(|m| [2, 3].map(|d| non_overlapping(&record, m, d)));
        figures.add(format!("{} without overlap", unit.name), &blocks);
    }
    figures.check("intervals.txt");
}
