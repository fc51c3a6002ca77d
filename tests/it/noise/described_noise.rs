//! A description with Markov noise, quasi-periodic disturbances and lines through measurands and figures.

use sagnac::acceptance::figures::{allan_family, autocorrelation, residual, sigma_tau, spectrum};
use sagnac::estimate::{Estimate, Spread};
use sagnac::figure::{Figure, Layer, Style};
use sagnac::i18n::{Lang, Localize};
use sagnac::measurand::{GyroEvidence, Options, find};
use sagnac::noise::composite::{Composite, Damped, Described, Line, Parameter, Sampling};
use sagnac::noise::data::NoiseType;
use sagnac::noise::digest::{DigestPlan, RateAccumulator};
use sagnac::noise::family::Estimator;
use sagnac::noise::identification::{MarkovFound, QuasiPeriodicFound};
use sagnac::noise::intervals::{BoundedPoint, bounded};
use sagnac::noise::lines::find_lines;
use sagnac::noise::model::NoiseModel;
use sagnac::noise::motion::Motion;
use sagnac::noise::residual::GoodnessOfFit;
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::spectral_record::SpectralRecord;

fn truth() -> Composite {
    Composite {
        terms: NoiseModel { n: 0.002, b: 0.004, ..Default::default() },
        markov: vec![
            Damped { rms_deg_h: 0.02, frequency_hz: 0.0, decay_time_s: 300.0 },
            Damped { rms_deg_h: 0.03, frequency_hz: 0.0, decay_time_s: 20.0 },
        ],
        quasi_periodic: vec![Damped { rms_deg_h: 0.05, frequency_hz: 0.03, decay_time_s: 400.0 }],
        lines: vec![Line { amplitude_deg_h: 0.05, frequency_hz: 0.2 }],
        ..Default::default()
    }
}

fn measured(id: &'static str, value: f64, unit: &'static str) -> Estimate {
    let spread = Spread::Normal { standard_uncertainty: 0.1 * value };
    Estimate::measured(id, "rate", value, unit, spread, "whittle")
}

/// A record of 65 536 s at 1 Hz with its true description in place of what identification found.
fn gyro() -> GyroEvidence {
    let model = truth();
    let mut accumulator =
        RateAccumulator::new(DigestPlan { estimators: Estimator::ALL.to_vec(), ..DigestPlan::new(1.0) });
    let samples = Simulator::of(&model, &Setup::for_record(20, 1.0, 65_536)).take(65_536);
    accumulator.push(&samples, 0, false);
    let digest = accumulator.finish();
    // The search may take the narrow disturbance for a line too: that one is in the description.
    let mut lines = find_lines(&digest.welch.spectrum, 1.0, 0.01).lines;
    lines.retain(|l| (l.frequency_hz - 0.2).abs() < 0.005);
    assert_eq!(lines.len(), 1);
    let record = SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s: 1.0,
        lines: &lines,
        sampling: Sampling::Averaging,
    };
    let mut identification = record.identify("rate").ranged.identification;
    identification.claimed.push(NoiseType::Flicker);
    identification.described = Described {
        parameters: vec![
            Parameter::Coefficient(NoiseType::AngleRandomWalk),
            Parameter::MarkovSigma(0),
            Parameter::QuasiPeriodicRms(0),
        ],
        covariance: vec![vec![1e-10, 0.0, 0.0], vec![0.0, 4e-6, 0.0], vec![0.0, 0.0, 9e-6]],
        model,
    };
    identification.markov = truth()
        .markov
        .iter()
        .map(|d| MarkovFound {
            sigma: measured("markov_sigma", d.rms_deg_h, "deg/h"),
            correlation_time: measured("markov_correlation_time", d.decay_time_s, "s"),
        })
        .collect();
    identification.quasi_periodic = vec![QuasiPeriodicFound {
        amplitude: measured("quasi_periodic_amplitude", 0.05, "deg/h"),
        frequency: measured("quasi_periodic_frequency", 0.03, "Hz"),
        coherence_time: measured("quasi_periodic_coherence_time", 400.0, "s"),
    }];
    let octaves: Vec<_> = digest
        .deviations
        .curve(Estimator::Allan)
        .map(|c| {
            let noise = NoiseType::AngleRandomWalk;
            c.points.iter().map(|p| bounded(Estimator::Allan, p, &c.stretches, noise)).collect()
        })
        .unwrap();
    let points: Vec<_> = octaves.iter().map(|b: &BoundedPoint| b.point).collect();
    let goodness = GoodnessOfFit::of(&record, &identification.described, &points);
    GyroEvidence {
        channel: "rate".into(),
        several: false,
        tau0_s: 1.0,
        longest_stretch_s: 65_536.0,
        sigma_tau: octaves.clone(),
        octaves,
        identification,
        goodness,
        lines,
        withheld_line: None,
        motion: Motion::Unknown,
        earth: None,
        digest,
        over_temperature: None,
        warm_up: None,
        course: None,
        rounding: Default::default(),
        noise_test: None,
        objections: Default::default(),
    }
}

const OPTIONS: Options = Options { remove_earth_rate: false };

#[test]
fn the_strongest_process_is_the_value_and_the_others_stand_in_a_note() {
    let gyro = gyro();
    for (id, value) in [
        ("markov_sigma", 0.03),
        ("markov_correlation_time", 20.0),
        ("quasi_periodic_amplitude", 0.05),
        ("quasi_periodic_frequency", 0.03),
        ("quasi_periodic_coherence_time", 400.0),
    ] {
        let estimate = find(id).unwrap().evaluate_gyro(&gyro, &OPTIONS).remove(0);
        assert_eq!((estimate.id, estimate.value), (id, Some(value)));
        let named = estimate.notes.iter().find(|n| n.id == "correlated.others");
        assert_eq!(named.is_some(), id.starts_with("markov"), "{id}");
        if let Some(named) = named {
            let words = named.say(Lang::En);
            assert!(words.contains("0.02") && words.contains("300") && !words.contains("0.03"), "{words}");
        }
    }
    let mut without = gyro;
    without.identification.markov.clear();
    without.identification.quasi_periodic.clear();
    for id in ["markov_sigma", "quasi_periodic_frequency"] {
        let none = find(id).unwrap().evaluate_gyro(&without, &OPTIONS).remove(0);
        assert!(none.value.is_none() && none.upper_limit.is_none() && !none.notes.is_empty(), "{id}");
    }
}

/// Style, legend and points of a line.
type Drawn<'a> = (Style, &'a str, &'a [(f64, f64)]);

fn lines(figure: &Figure, panel: usize) -> Vec<Drawn<'_>> {
    let layers = figure.panels[panel].layers.iter();
    layers
        .filter_map(|l| match l {
            Layer::Line { points, style, legend } => Some((*style, legend.as_str(), points.as_slice())),
            _ => None,
        })
        .collect()
}

#[test]
fn every_part_of_the_description_is_drawn_and_named() {
    let gyro = gyro();
    let figure = sigma_tau::figure(&gyro, &|_| None);
    let drawn = lines(&figure, 0);
    let parts = ["angle_random_walk", "bias_instability"].map(|p| format!("figure.legend.{p}"));
    let others = ["markov", "quasi_periodic", "lines"].map(|p| format!("figure.fit.{p}"));
    for legend in parts.iter().chain(&others) {
        assert!(drawn.iter().any(|d| d.1 == legend.as_str()), "{legend} is not drawn");
    }
    // Processes of one kind look alike, those of different kinds do not.
    let style = |legend: &str| drawn.iter().find(|d| d.1 == legend).unwrap().0;
    assert_ne!(style("figure.fit.markov"), style("figure.fit.quasi_periodic"));
    assert_eq!(drawn.iter().filter(|d| d.1 == "figure.fit.markov").count(), 2);
    // The whole is the root of the sum of squares, and lies inside its band.
    let model = drawn.iter().find(|d| d.1 == "figure.legend.model").unwrap().2;
    for (tau, sigma) in model {
        assert!((sigma / truth().allan_variance(*tau, 1.0).sqrt() - 1.0).abs() < 1e-9);
    }
    let band = figure.panels[0].layers.iter().find_map(|l| match l {
        Layer::Band { points, legend, .. } if legend == "figure.fit.model_band" => Some(points),
        _ => None,
    });
    for ((tau, low, high), (_, sigma)) in band.unwrap().iter().zip(model) {
        assert!(low < sigma && sigma < high, "{tau}");
    }
}

#[test]
fn the_spectrum_resolves_a_narrow_disturbance_and_stands_over_its_ratio() {
    let gyro = gyro();
    let figure = spectrum::figure(&gyro).unwrap();
    assert_eq!(figure.panels.len(), 2);
    let drawn = lines(&figure, 0);
    let peak = drawn.iter().find(|d| d.1 == "figure.fit.quasi_periodic").unwrap().2;
    let highest = peak.iter().map(|p| p.1).fold(0.0, f64::max);
    // σ²T at the centre: half of the power on each side of zero frequency.
    assert!((highest / (0.0025 * 400.0) - 1.0).abs() < 0.02, "{highest}");
    let ratios = lines(&figure, 1)[0].2;
    let inside = ratios.iter().filter(|(f, _)| (*f - 0.2).abs() > 0.02);
    // Bands of 12 degrees of freedom and more: a factor of three is beyond five standard deviations.
    assert!(inside.clone().count() > 60 && inside.clone().all(|(_, r)| (0.2..3.0).contains(r)), "{ratios:?}");
}

#[test]
fn residual_figures_show_white_normal_noise_for_a_true_description() {
    let gyro = gyro();
    let figure = residual::figure(&gyro).unwrap();
    let bars = figure.panels[0].layers.iter().find_map(|l| match l {
        Layer::Bars { bars, .. } => Some(bars),
        _ => None,
    });
    // Values between 0 and 0.25 standard deviations: 9.87 % of a normal distribution.
    let central = bars.unwrap().iter().find(|b| b.0 == 0.0).unwrap().2 / 65_536.0;
    assert!((central - 0.0987).abs() < 0.004, "{central}");
    let figure = autocorrelation::figure(&gyro).unwrap();
    let left = lines(&figure, 1);
    assert_eq!(left[0].1, "figure.fit.whitened");
    let beyond = left[0].2.iter().filter(|(_, r)| r.abs() > 1.96 / 256.0).count();
    assert!(beyond <= 12, "{beyond} of {} lags", left[0].2.len());
    let record = lines(&figure, 0);
    assert!(record[0].2[0].1 > 0.1, "the record itself is correlated");
}

#[test]
fn the_family_shows_four_estimators() {
    let figure = allan_family::figure(&gyro()).unwrap();
    let drawn = lines(&figure, 0);
    assert_eq!(drawn.len(), 4);
    for (i, a) in drawn.iter().enumerate() {
        assert!(drawn[i + 1..].iter().all(|b| a.0 != b.0 && a.1 != b.1));
        assert!(a.2.len() > 10);
    }
}

/// Writes the figures where they can be looked at.
#[test]
#[ignore = "for looking at: FIGURES names a folder"]
fn draw() {
    let folder = std::env::var("FIGURES").expect("FIGURES names a folder");
    let gyro = gyro();
    let figures: Vec<Figure> = [
        Some(sigma_tau::figure(&gyro, &|_| None)),
        spectrum::figure(&gyro),
        autocorrelation::figure(&gyro),
        residual::figure(&gyro),
        allan_family::figure(&gyro),
    ]
    .into_iter()
    .flatten()
    .collect();
    sagnac::report::write_figures(std::path::Path::new(&folder), &figures, Lang::En).unwrap();
    assert_eq!(figures.len(), 5);
}
