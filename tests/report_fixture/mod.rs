//! Run records and figures with invented numbers, as realistic as a report needs to be judged by.
#![allow(dead_code)]

pub mod figures;

use sagnac::estimate::{Interval, Rule, UpperLimit, Verdict};
use sagnac::record::*;
use sagnac::text::Note;

/// A sentence with a key that no table has shows its key; fixtures say what they mean by one of the real keys.
fn note(id: &'static str) -> Note {
    Note::new(id)
}

pub fn limit(max: f64, acceptance: f64, unit: &str) -> LimitRecord {
    LimitRecord {
        min: None,
        max: Some(max),
        unit: unit.into(),
        rule: Rule::GuardBand,
        risk: 0.05,
        acceptance_min: None,
        acceptance_max: Some(acceptance),
        source: "procedures/limits/oius-501.toml".into(),
    }
}

pub fn row(id: &str, channel: &str, value: f64, (low, high): (f64, f64), unit: &str) -> MeasurandRecord {
    MeasurandRecord {
        id: id.into(),
        channel: channel.into(),
        phase: None,
        value: Some(value),
        unit: unit.into(),
        interval: Some(Interval { low, high, coverage: 0.95 }),
        identifiable: true,
        upper_limit: None,
        method: if id.starts_with("russian") { "mean" } else { "whittle" }.into(),
        limit: None,
        reference: None,
        verdict: Verdict::None,
        margin: None,
        specific_risk: None,
        notes: vec![],
    }
}

pub fn at_most(id: &str, channel: &str, value: f64, unit: &str) -> MeasurandRecord {
    MeasurandRecord {
        value: None,
        interval: None,
        identifiable: false,
        upper_limit: Some(UpperLimit { value, coverage: 0.95 }),
        ..row(id, channel, 0.0, (0.0, 0.0), unit)
    }
}

pub fn judged(
    mut row: MeasurandRecord,
    max: f64,
    acceptance: f64,
    risk: f64,
    verdict: Verdict,
) -> MeasurandRecord {
    row.margin = row.value.or(row.upper_limit.map(|u| u.value)).map(|v| max - v);
    row.limit = Some(limit(max, acceptance, &row.unit));
    row.specific_risk = Some(risk);
    row.verdict = verdict;
    row
}

fn channel_rows(channel: &str, scale: f64) -> Vec<MeasurandRecord> {
    let s = |v: f64| v * scale;
    let mut bias = judged(
        row("static_bias", channel, -0.012_348 * scale, (-0.013_9, -0.010_8), "deg/h"),
        0.05,
        0.0487,
        0.0,
        Verdict::Pass,
    );
    if let Some(l) = &mut bias.limit {
        l.min = Some(-0.05);
        l.acceptance_min = Some(-0.0487);
    }
    bias.notes.push(note("methods.earth_rate.text"));
    let mut arw = judged(
        row("angle_random_walk", channel, s(0.002_314_9), (s(0.002_296), s(0.002_334)), "deg/sqrt(h)"),
        0.003,
        0.002_983,
        1e-9,
        Verdict::Pass,
    );
    arw.reference =
        Some(ReferenceRecord { value: 0.0023, source: "published typical values, OIUS-501".into() });
    let mut b =
        judged(at_most("bias_instability", channel, 0.001_42, "deg/h"), 0.0015, 0.0015, 0.03, Verdict::Pass);
    b.limit.as_mut().unwrap().acceptance_max = None;
    b.specific_risk = None;
    b.notes.push(note("methods.not_identifiable.text"));
    vec![
        bias,
        arw,
        b,
        judged(
            row("russian_drift_100s", channel, s(0.013_92), (s(0.012_94), s(0.015_05)), "deg/h"),
            0.02,
            0.018_81,
            2e-7,
            Verdict::Pass,
        ),
        row("bias_instability_minimum", channel, s(0.001_21), (s(0.000_86), s(0.002_05)), "deg/h"),
        row("bias_instability_minimum_scaled", channel, s(0.001_82), (s(0.001_29), s(0.003_09)), "deg/h"),
        at_most("rate_random_walk", channel, 0.000_512, "deg/h/sqrt(h)"),
        at_most("rate_ramp", channel, 0.000_333, "deg/h/h"),
        at_most("quantization", channel, 0.000_021, "arcsec"),
        row("russian_drift_100s_3sigma", channel, s(0.041_76), (s(0.038_8), s(0.045_1)), "deg/h"),
        row("russian_sigma_10s", channel, s(0.043_9), (s(0.042_9), s(0.044_9)), "deg/h"),
        row("russian_arw_10s", channel, s(0.002_314), (s(0.002_261), s(0.002_366)), "deg/sqrt(h)"),
        row("russian_drift_100s_predicted", channel, s(0.013_89), (s(0.013_7), s(0.014_1)), "deg/h"),
        row("ratio_russian_to_allan_bias", channel, 11.5, (6.6, 16.4), "1"),
        row("ratio_russian_to_allan_arw", channel, 0.9996, (0.974, 1.025), "1"),
    ]
}

fn condition(
    id: &str,
    status: ConditionStatus,
    required: &str,
    observed: &[(&str, f64)],
    text: &str,
) -> ConditionRecord {
    ConditionRecord {
        id: id.into(),
        phase: None,
        status,
        observed: observed.iter().map(|(k, v)| ((*k).to_owned(), serde_json::json!(v))).collect(),
        required: required.into(),
        requirement: None,
        note: text.into(),
        message: None,
    }
}

const DIGEST: &str = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08";

/// A static test of one channel that passes.
pub fn pass() -> RunRecord {
    RunRecord {
        format: RESULT_FORMAT,
        program: Program { name: "sagnac", version: "0.1.0".into() },
        kind: "run",
        procedure: Some(ProcedureRecord {
            id: "static-bias".into(),
            title: "Static test: bias and noise at rest".into(),
            revision: "A".into(),
            standard: Some("IEEE Std 952-2020".into()),
            clause: Some("12.11".into()),
            author: Some("Quality assurance".into()),
            path: "procedures/static-bias.toml".into(),
            sha256: DIGEST.into(),
            limits: Some(LimitsFile {
                id: "oius-501".into(),
                title: "OIUS-501 acceptance".into(),
                revision: "2".into(),
                source: Some("published typical values, factor 1.3".into()),
                path: "procedures/limits/oius-501.toml".into(),
                sha256: DIGEST.chars().rev().collect(),
            }),
        }),
        unit_under_test: UnitUnderTest {
            serial: Some("F501-0417".into()),
            family: Some("OIUS-501".into()),
            part: Some("501.00.000-02".into()),
            revision: None,
            lot: Some("2026-11".into()),
        },
        session: Session {
            operator: Some("A. Tester".into()),
            station: Some("Rig 3".into()),
            evaluated_at: "2026-11-20T16:42:07Z".into(),
        },
        recording: vec![RecordingFile {
            path: "samples/unit-pass.csv.gz".into(),
            sha256: DIGEST.into(),
            bytes: 1_482_112,
            samples: 36_000,
            sample_interval_s: 1.0,
            sample_interval_uncertainty_s: Some(1e-9),
            clock_drift_ppm: None,
            phase: None,
            start: Some("2026-11-20T04:10:00Z".into()),
            duration_s: 36_000.0,
            columns: vec![
                ColumnRecord {
                    name: "rate".into(),
                    channel: "rate".into(),
                    role: "rate".into(),
                    unit: "deg/h".into(),
                },
                ColumnRecord {
                    name: "T_case".into(),
                    channel: "temperature".into(),
                    role: "temperature".into(),
                    unit: "degC".into(),
                },
            ],
        }],
        verdict: Verdict::Pass,
        summary: vec![note("methods.verdict.text")],
        conditions: vec![
            condition(
                "temperature",
                ConditionStatus::Ok,
                "20 ± 0.4 °C",
                &[("min", 19.8123), ("max", 20.2034)],
                "With the sensor's uncertainty of 0.05 °C.",
            ),
            condition("duration", ConditionStatus::Ok, "at least 10 h", &[("value", 10.0)], ""),
            condition(
                "warm_up",
                ConditionStatus::Remark,
                "0.5 h",
                &[("value", 0.5)],
                "The fitted tail would need 0.62 h.",
            ),
            condition("gaps", ConditionStatus::Ok, "at most 10 missing samples", &[("count", 0.0)], ""),
        ],
        integrity: Integrity {
            outliers: 1,
            timestamp_jitter_s: Some(1.3e-6),
            quantization_step_deg_h: Some(1e-5),
            outlier_threshold: Some(6.5),
            faults: vec![FaultRecord {
                kind: "outlier".into(),
                channel: Some("rate".into()),
                time_s: Some(17_233.0),
                file: None,
                row: 17_234,
                count: 1,
                note: "1.23 deg/h, 8.1 robust standard deviations from the median".into(),
                message: None,
            }],
            ..Integrity::default()
        },
        window: Window {
            from_s: 1800.0,
            to_s: 36_000.0,
            usable_s: 34_199.0,
            excluded: vec![
                ExcludedSpan { from_s: 0.0, to_s: 1800.0, reason: "warm_up".into() },
                ExcludedSpan { from_s: 22_000.0, to_s: 22_600.0, reason: "declared".into() },
            ],
        },
        measurands: channel_rows("rate", 1.0),
        lines: vec![LineRecord {
            channel: "rate".into(),
            frequency_hz: 0.0833,
            resolution_hz: 0.000_244,
            amplitude_deg_h: 0.0123,
            excess: 38.2,
            false_alarm_probability: 3.1e-7,
        }],
        noise_models: vec![model("rate", 1.0)],
        goodness_of_fit: vec![
            goodness(
                "frequency",
                Note::new("goodness.frequency_more")
                    .with("from_hz", 0.3)
                    .with("to_hz", 0.5)
                    .with("percent", 12.0),
                true,
            ),
            goodness("lag", Note::new("goodness.fits"), false),
        ],
        deviations: ["oadev", "mdev"]
            .into_iter()
            .flat_map(|estimator| [1.0, 2.0].map(|tau_s| deviation(estimator, tau_s)))
            .collect(),
        table_steps: vec![],
        interval_means: vec![],
        phases: vec![],
        comparison: vec![],
        explained: None,
        power: vec![PowerRecord {
            id: "bias_instability".into(),
            channel: "rate".into(),
            limit: 0.0015,
            unit: "deg/h".into(),
            power: 0.12,
            pass_probability: 0.41,
            needed_h: Some(96.0),
            message: note("methods.power.text"),
        }],
        instruments: vec![
            InstrumentRecord {
                name: "Thermal chamber KT-2".into(),
                serial: Some("118".into()),
                calibration_due: Some("2027-03-01".into()),
                status: ConditionStatus::Ok,
            },
            InstrumentRecord {
                name: "Thermometer".into(),
                serial: None,
                calibration_due: Some("2026-10-01".into()),
                status: ConditionStatus::Invalid,
            },
        ],
        waivers: vec![],
        clauses: vec![
            ClauseRecord {
                clause: "12.5–12.6".into(),
                title: "Turn-on and warm-up time".into(),
                status: "elsewhere".into(),
                note: "procedure warm-up".into(),
            },
            ClauseRecord {
                clause: "12.11".into(),
                title: "Drift-rate series: bias, random drift".into(),
                status: "here".into(),
                note: "this report".into(),
            },
            ClauseRecord {
                clause: "12.12".into(),
                title: "Input-axis alignment".into(),
                status: "not_applicable".into(),
                note: "no table".into(),
            },
        ],
        options: vec![
            OptionRecord { name: "noise.fit.longest_tau".into(), value: "T/5".into() },
            OptionRecord { name: "russian.detrend".into(), value: "none".into() },
        ],
        figures: ["time_series", "sigma_tau", "spectrum", "autocorrelation", "histogram"]
            .map(|id| FigureRecord { id: id.into(), file: format!("figures/{id}.svg") })
            .into(),
        errors: vec![],
    }
}

fn goodness(view: &str, message: Note, departs: bool) -> GoodnessOfFitRecord {
    GoodnessOfFitRecord {
        channel: "rate".into(),
        view: view.into(),
        statistic: 6.1,
        p_value: if departs { 2.3e-8 } else { 0.41 },
        departs,
        from: 0.3,
        to: Some(0.5),
        excess: 0.12,
        message,
    }
}

fn deviation(estimator: &str, tau_s: f64) -> DeviationRecord {
    DeviationRecord {
        channel: "rate".into(),
        estimator: estimator.into(),
        tau_s,
        deviation_deg_h: 0.139 / tau_s.sqrt(),
        low_deg_h: Some(0.138 / tau_s.sqrt()),
        high_deg_h: Some(0.140 / tau_s.sqrt()),
        edf: 24_000.0 / tau_s,
    }
}

fn model(channel: &str, scale: f64) -> NoiseModelRecord {
    NoiseModelRecord {
        channel: channel.into(),
        method: "whittle".into(),
        terms: vec!["angle_random_walk".into()],
        angle_random_walk: 0.002_314_9 * scale,
        bias_instability: 0.000_21,
        rate_random_walk: 0.0,
        rate_ramp: 1.2e-4,
        quantization: 0.0,
        misfit: 1.013,
        misfit_probability: 0.31,
        misfit_band_hz: None,
        markov: vec![[0.0123, 456.0]],
        quasi_periodic: vec![],
        cutoff_hz: None,
        remarks: vec![
            Note::new("described.markov").with("sigma", 0.0123).with("time_s", 456.0),
            Note::new("described.leaves_out"),
        ],
    }
}

/// Three channels, one of which fails, with a waiver.
pub fn three_channels() -> RunRecord {
    let mut record = pass();
    record.measurands =
        ["x", "y", "z"].iter().zip([1.0, 1.1, 1.0]).flat_map(|(c, s)| channel_rows(c, s)).collect();
    for row in &mut record.measurands {
        if row.channel == "y" && row.id == "angle_random_walk" {
            row.value = Some(0.003_41);
            row.interval = Some(Interval { low: 0.003_38, high: 0.003_44, coverage: 0.95 });
            row.margin = Some(-0.000_41);
            row.specific_risk = Some(1.0);
            row.verdict = Verdict::Fail;
        }
    }
    record.noise_models = vec![model("x", 1.0), model("y", 1.5), model("z", 1.0)];
    record.noise_models[1].misfit = 1.42;
    record.noise_models[1].misfit_probability = 2.1e-6;
    record.noise_models[1].misfit_band_hz = Some([0.0123, 0.0345]);
    record.verdict = Verdict::Fail;
    record.waivers = vec![WaiverRecord {
        row: "angle_random_walk".into(),
        by: "Chief inspector".into(),
        reason: "To be used on the y axis of training rigs | only".into(),
        date: "2026-11-21".into(),
    }];
    record
}

/// A run that could not be carried out: no serial, nothing measured.
pub fn error() -> RunRecord {
    let mut record = pass();
    record.verdict = Verdict::Error;
    record.errors = vec![note("methods.not_identifiable.text")];
    record.summary = vec![];
    record.unit_under_test = UnitUnderTest::default();
    record.measurands = vec![];
    record.lines = vec![];
    record.noise_models = vec![];
    record.power = vec![];
    record.figures = vec![];
    record.integrity = Integrity { gaps: 3, missing_samples: 12_345, ..Integrity::default() };
    record
}

/// A condition was not met: the whole is indeterminate.
pub fn indeterminate() -> RunRecord {
    let mut record = pass();
    record.verdict = Verdict::Indeterminate;
    record.conditions[0].status = ConditionStatus::Invalid;
    record.conditions[0].note = "20.9 °C at 13 500 s; 2.1 % of the record lies outside.".into();
    record
}

/// An analysis without procedure and limits.
pub fn analysis() -> RunRecord {
    let mut record = pass();
    record.kind = "analyze";
    record.procedure = None;
    record.verdict = Verdict::None;
    record.conditions = vec![];
    record.instruments = vec![];
    record.power = vec![];
    record.clauses = vec![];
    for row in &mut record.measurands {
        row.limit = None;
        row.margin = None;
        row.specific_risk = None;
        row.verdict = Verdict::None;
    }
    record
}
