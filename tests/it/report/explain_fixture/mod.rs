//! Explanations made by hand, one of each verdict.
#![allow(dead_code, reason = "each test file uses its own part")]

use sagnac::effect::Domain;
use sagnac::mismatch::finding::{
    Candidate, Experiment, Explanation, Finding, Fit, FitFigures, MismatchVerdict, NuisanceValue,
    ParameterValue, PlaceRecord, RecordingFacts, Test,
};
use std::collections::BTreeMap;

/// Every kind of the contract with the parameters that it lists, but `unknown`.
pub const KINDS: &[(&str, &[(&str, &str)])] = &[
    ("temp_linear", &[("coefficient_deg_h_per_degC", "deg/h/degC"), RMS]),
    ("temp_polynomial", &[RMS]),
    ("temp_rate", &[("coefficient_deg_h_per_degC_per_min", "deg/h/(degC/min)"), RMS]),
    ("thermal_lag", &[("time_constant_s", "s"), RMS]),
    ("temp_hysteresis", &[("loop_width_deg_h", "deg/h"), RMS]),
    ("warmup_exponential", &[("amplitude_deg_h", "deg/h"), ("time_constant_s", "s"), RMS]),
    ("rate_ramp", &[("slope_deg_h_per_h", "deg/h/h"), RMS]),
    ("diurnal", &[("amplitude_deg_h", "deg/h"), ("period_s", "s"), RMS]),
    ("unobserved_driver", &[RMS]),
    ("excess_arw", &[("N_deg_rt_h", "deg/sqrt(h)")]),
    ("excess_flicker", &[("B_deg_h", "deg/h")]),
    ("excess_rrw", &[("K_deg_h_rt_h", "deg/h/sqrt(h)")]),
    ("markov_short", &[("correlation_time_s", "s"), ("sigma_deg_h", "deg/h"), RMS]),
    ("markov_long", &[("correlation_time_s", "s"), ("sigma_deg_h", "deg/h"), RMS]),
    (
        "quasi_periodic",
        &[("frequency_hz", "Hz"), ("amplitude_rms_deg_h", "deg/h"), ("coherence_time_s", "s"), RMS],
    ),
    ("line", &[("frequency_hz", "Hz"), ("amplitude_deg_h", "deg/h"), RMS]),
    ("comb", &[("fundamental_hz", "Hz"), RMS]),
    ("quantization", &[("lsb_arcsec", "arcsec"), RMS]),
    ("bandwidth_filter", &[("cutoff_hz", "Hz")]),
    ("noise_variance_time", &[("ratio", "")]),
    ("noise_variance_rate", &[("ratio", "")]),
    ("outlier_bursts", &[("count", ""), RMS]),
    ("random_telegraph", &[("amplitude_deg_h", "deg/h"), ("mean_dwell_s", "s"), RMS]),
    ("bias_step", &[("step_deg_h", "deg/h"), ("time_s", "s"), RMS]),
    ("heading_change", &[("step_deg_h", "deg/h"), ("time_s", "s"), RMS]),
    ("earth_rate_projection", &[("amplitude_deg_h", "deg/h"), RMS]),
    ("table_harmonic", &[("order", ""), ("amplitude_deg_h", "deg/h"), RMS]),
    ("reset_ripple", &[("period_arcsec", "arcsec"), RMS]),
    ("sf_error", &[("error_ppm", "ppm"), RMS]),
    ("sf_asymmetry", &[("asymmetry_ppm", "ppm"), RMS]),
    ("sf_nonlinearity", &[("cubic_ppm_at_max", "ppm"), RMS]),
    ("sf_temperature", &[("coefficient_ppm_per_degC", "ppm/degC"), RMS]),
    ("dead_zone", &[("half_width_deg_h", "deg/h"), RMS]),
    ("saturation", &[("limit_deg_s", "deg/s"), RMS]),
    ("cross_axis", &[("misalignment_mrad", "mrad"), RMS]),
    ("supply_sensitivity", &[("coefficient_deg_h_per_V", "deg/h/V"), RMS]),
    ("column_driver", &[("coefficient", ""), RMS]),
    ("noise_variance_driver", &[("ratio", "")]),
    ("sf_driver", &[("coefficient_ppm", "ppm"), RMS]),
    ("dropped_samples", &[("missing_rows", "")]),
    ("time_offset", &[("lag_s", "s"), RMS]),
    ("clock_drift", &[("drift_ppm", "ppm"), RMS]),
];

const RMS: (&str, &str) = ("rms_deg_h", "deg/h");

/// Domains of the contract.
pub const DOMAINS: &[&str] = &[
    "time",
    "frequency",
    "lag",
    "temperature",
    "temperature_rate",
    "input_rate",
    "outer_rate",
    "angle",
    "amplitude",
    "timestamps",
    "supply",
    "driver",
];

/// A parameter.
pub fn parameter(value: f64, half: f64, unit: &str) -> ParameterValue {
    ParameterValue { value, unit: unit.into(), ci95: [value - half, value + half] }
}

/// A place.
pub fn place(domain: &str, from: f64, to: f64) -> PlaceRecord {
    PlaceRecord { domain: Domain::of_id(domain).unwrap(), from, to }
}

/// A finding of a kind with all its parameters.
pub fn of_kind(kind: &str) -> Finding {
    let listed = KINDS.iter().find(|k| k.0 == kind).map_or(&[][..], |k| k.1);
    let follows_any = ["column_driver", "noise_variance_driver", "sf_driver"].contains(&kind);
    Finding {
        kind: kind.into(),
        effect: None,
        column: follows_any.then(|| "pressure_hPa".into()),
        column2: None,
        law: (kind == "column_driver").then(|| "lag".into()),
        formula: None,
        shape: None,
        equivalents: vec![],
        probabilities: std::collections::BTreeMap::new(),
        parameters: listed
            .iter()
            .map(|(name, unit)| ((*name).to_owned(), parameter(3.0, 0.25, unit)))
            .collect(),
        places: vec![place("time", 5100.0, 5300.0)],
        delta_bic: 212.4,
        p_value: 1e-40,
        heldout_gain: Some(54.1),
        removed_share: Some(0.96),
    }
}

fn figures(log_likelihood: f64, heldout: f64, rms: f64, bic: f64) -> FitFigures {
    FitFigures { log_likelihood, heldout_log_likelihood: heldout, heldout_rms_deg_h: rms, bic }
}

fn test(id: &str, place: PlaceRecord, p_before: f64, p_after: f64) -> Test {
    Test { id: id.into(), domain: place.domain, from: place.from, to: place.to, p_before, p_after }
}

/// A correct claim.
pub fn consistent() -> Explanation {
    let fit = figures(-1234.5, -620.1, 0.1412, 2500.9);
    Explanation {
        format: "explain/1".into(),
        case: "case-000".into(),
        verdict: MismatchVerdict::Consistent,
        effects: vec![],
        rest: None,
        fit: Fit { heldout_tau_s: 10.0, baseline: fit.clone(), augmented: fit },
        family_p_value: 0.432,
        family_p_value_after: 0.432,
        alpha: 0.01,
        candidates: vec![],
        tests: vec![
            test("spectrum", place("frequency", 0.0012, 0.0047), 0.21, 0.21),
            test("skewness", place("amplitude", -4.1, 4.3), 0.08, 0.08),
        ],
        nuisances: vec![
            nuisance("noise.N_deg_rt_h", "deg/sqrt(h)", 0.0023, 3.45e-5, 0.002_312),
            nuisance("bias.value_deg_h", "deg/h", -3.1, 0.0, -3.104),
        ],
        recording: RecordingFacts {
            rows: 36_000,
            missing: 0,
            sample_interval_s: 1.0,
            length_s: 35_999.0,
            columns: vec!["temp_degC".into()],
            hidden: vec![],
        },
        columns: vec![],
        noticeable: vec![],
        noticeable_not_computed: vec![],
        experiments: vec![],
    }
}

fn nuisance(name: &str, unit: &str, claimed: f64, uncertainty: f64, fitted: f64) -> NuisanceValue {
    NuisanceValue {
        name: name.into(),
        unit: unit.into(),
        claimed,
        uncertainty,
        baseline: fitted,
        augmented: fitted,
    }
}

/// A claim without the findings given, which explain it.
pub fn explained(effects: Vec<Finding>) -> Explanation {
    let chosen = effects.first().map_or("", |f| f.kind.as_str()).to_owned();
    let candidate = |kind: &str, delta_bic: f64, p_value: f64| Candidate {
        kind: kind.into(),
        delta_bic,
        log_likelihood_gain: 0.5 * delta_bic + 21.0,
        p_value,
    };
    Explanation {
        verdict: MismatchVerdict::Mismatch,
        candidates: vec![
            candidate(&chosen, 212.4, 1e-40),
            candidate("excess_rrw", 96.2, 3e-22),
            candidate("markov_long", -4.0, 0.2),
        ],
        tests: vec![
            test("skewness", place("amplitude", -4.1, 4.3), 0.08, 0.3),
            test("level", place("time", 5190.0, 5280.0), 2.2e-45, 0.61),
        ],
        effects,
        rest: None,
        fit: Fit {
            heldout_tau_s: 10.0,
            baseline: figures(-1234.5, -620.1, 0.1412, 2500.9),
            augmented: figures(-1112.1, -566.0, 0.1403, 2288.5),
        },
        family_p_value: 1e-43,
        family_p_value_after: 0.52,
        ..consistent()
    }
}

/// A step that a change of heading could be as well.
pub fn bias_step() -> Explanation {
    let mut finding = of_kind("bias_step");
    finding.parameters = BTreeMap::from([
        ("step_deg_h".to_owned(), parameter(0.031_23, 0.0021, "deg/h")),
        ("time_s".to_owned(), parameter(5231.0, 12.0, "s")),
        ("rms_deg_h".to_owned(), parameter(0.0112, 0.0008, "deg/h")),
    ]);
    finding.places = vec![place("time", 5200.0, 5262.0)];
    finding.equivalents = vec!["heading_change".into()];
    let mut all = explained(vec![finding]);
    all.experiments =
        vec![Experiment { kind: "bias_step".into(), against: "heading_change".into(), times_longer: None }];
    all
}

/// A stated N that is too low, and a Markov process that a walk could be as well.
pub fn two() -> Explanation {
    let mut first = of_kind("excess_arw");
    first.parameters =
        BTreeMap::from([("N_deg_rt_h".to_owned(), parameter(0.003_012, 0.000_031, "deg/sqrt(h)"))]);
    first.places = vec![place("frequency", 0.004, 0.5)];
    let mut second = of_kind("markov_long");
    second.parameters = BTreeMap::from([
        (
            "correlation_time_s".to_owned(),
            ParameterValue { value: 900.0, unit: "s".into(), ci95: [610.0, 1500.0] },
        ),
        ("sigma_deg_h".to_owned(), parameter(0.0124, 0.0011, "deg/h")),
    ]);
    second.places = vec![place("lag", 100.0, 1800.0), place("frequency", 2.8e-5, 0.001)];
    second.equivalents = vec!["excess_rrw".into()];
    let mut all = explained(vec![first, second]);
    all.experiments = vec![Experiment {
        kind: "markov_long".into(),
        against: "excess_rrw".into(),
        times_longer: Some(3.42),
    }];
    all
}

/// A mismatch without a name.
pub fn unknown() -> Explanation {
    let mut finding = of_kind("unknown");
    finding.places = vec![place("temperature", 31.2, 38.9)];
    finding.parameters = BTreeMap::from([("rms_deg_h".to_owned(), parameter(0.021, 0.002, "deg/h"))]);
    finding.removed_share = None;
    finding.heldout_gain = None;
    let baseline = consistent().fit;
    Explanation {
        verdict: MismatchVerdict::UnknownMismatch,
        fit: baseline,
        family_p_value: 3.1e-9,
        family_p_value_after: 3.1e-9,
        ..explained(vec![finding])
    }
}
