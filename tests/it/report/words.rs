//! Every id that a run can write into a result has words, asked of what writes them: the conditions, the measurands and
//! real runs over the samples.

use crate::support::tested::tested;
use sagnac::acceptance::bench::OnBench;
use sagnac::acceptance::condition::checks::CheckLog;
use sagnac::acceptance::condition::stability_track::{Extreme, StabilityFacts, StabilityKey};
use sagnac::acceptance::condition::status_track::StatusTrack;
use sagnac::acceptance::condition::{
    ALL_CONDITIONS, BiasStep, ColumnFact, Facts, GyroFact, NoiseChange, WarmUpFact, judge_all,
};
use sagnac::config::procedure::bench::Bench;
use sagnac::config::procedure::model::{
    Allowance, EarthRate, FaultBudget, MeasurandSpec, RangeCondition, StatusCondition, SupplyCondition,
};
use sagnac::config::procedure::{EffectiveLimits, effective, load, load_limits};
use sagnac::i18n::{Lang, Localize, lookup};
use sagnac::measurand::{MEASURANDS, Test};
use sagnac::noise::model::TERMS;
use sagnac::noise::tails::TailShape;
use sagnac::record::RunRecord;
use sagnac::recording::integrity::Integrity;
use sagnac::temperature::SegmentKind;
use sagnac::temperature::course::Span;
use sagnac::temperature::findings::Schedule;
use sagnac::temperature::segments::Segment;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

fn root(path: &str) -> PathBuf {
    crate::support::root().join(path)
}

fn missing(keys: impl IntoIterator<Item = String>) -> BTreeSet<String> {
    keys.into_iter().filter(|k| lookup(Lang::En, k).is_none()).collect()
}

/// A sample tested by the static procedure, with every measurand that this version gives.
fn run(sample: &str) -> RunRecord {
    let mut procedure = load(&root("procedures/static-bias.toml")).unwrap();
    procedure.value.measurands = MEASURANDS
        .iter()
        .filter(|m| m.test() == Test::Static)
        .map(|measurand| MeasurandSpec {
            measurand,
            channel: None,
            earth_rate: EarthRate::Remove,
            span: 0..0,
        })
        .collect();
    tested(&procedure, &root(sample)).unwrap()
}

#[test]
fn every_id_of_a_run_has_words() {
    let mut measured = BTreeSet::new();
    for sample in ["samples/unit-pass.csv", "samples/unit-faults.csv"] {
        let r = run(sample);
        let mut keys = BTreeSet::new();
        for m in &r.measurands {
            measured.insert(m.id.clone());
            keys.extend([format!("measurand.{}", m.id), format!("how.{}", m.method)]);
            keys.extend(m.notes.iter().map(|n| n.id.to_string()));
        }
        keys.extend(r.noise_models.iter().map(|m| format!("how.{}", m.method)));
        keys.extend(r.options.iter().map(|o| format!("option.{}", o.name)));
        keys.extend(r.integrity.faults.iter().map(|f| format!("fault.{}", f.kind)));
        keys.extend(r.window.excluded.iter().map(|e| format!("excluded.{}", e.reason)));
        keys.extend(r.clauses.iter().map(|c| format!("clause.{}", c.status)));
        keys.extend(r.recording.iter().flat_map(|f| &f.columns).map(|c| format!("role.{}", c.role.id())));
        keys.extend(r.summary.iter().chain(&r.errors).map(|n| n.id.to_string()));
        keys.extend(r.power.iter().map(|p| p.message.id.to_string()));
        assert!(keys.len() > 30, "{sample} shows {} ids only", keys.len());
        assert!(missing(keys.clone()).is_empty(), "{sample}: {:?}", missing(keys));
    }
    let given = MEASURANDS.iter().filter(|m| m.test() == Test::Static);
    let unseen: Vec<&str> = given.map(|m| m.id).filter(|id| !measured.contains(*id)).collect();
    assert!(unseen.is_empty(), "no run gave {unseen:?}, so the names of their methods were not seen");
}

#[test]
fn every_measurand_and_term_has_a_name() {
    assert!(MEASURANDS.len() > 40 && TERMS.len() == 5);
    assert_eq!(missing(MEASURANDS.iter().map(|m| format!("measurand.{}", m.id))), BTreeSet::new());
    assert_eq!(missing(TERMS.iter().map(|t| format!("term.{}", t.id()))), BTreeSet::new());
}

#[allow(clippy::too_many_lines, reason = "one list of cases or data")]
#[test]
fn every_condition_has_words_for_what_it_requires_and_observes() {
    let mut procedure = load(&root("procedures/static-bias.toml")).unwrap().value;
    let strict = Some(Allowance::Count(0));
    procedure.conditions.faults = FaultBudget {
        gaps: strict,
        missing_samples: Some(Allowance::Share(1e-6)),
        longest_gap_s: Some(1.0),
        duplicate_timestamps: strict,
        backward_timestamps: strict,
        non_finite: strict,
        unparsable: strict,
        outliers: strict,
        saturated: strict,
        stuck: strict,
        repeated: strict,
        timestamp_jitter_s: Some(1e-3),
    };
    procedure.sample_rate_hz = Some(1.0);
    procedure.conditions.supplies = vec![SupplyCondition {
        channel: "supply".into(),
        nominal_v: 5.0,
        tolerance_v: 0.1,
        sensor_uncertainty_v: 0.01,
        coverage_factor: 2.0,
    }];
    procedure.conditions.ranges = vec![RangeCondition {
        channel: "temp".into(),
        min: Some("19 degC".into()),
        max: Some("21 degC".into()),
        sensor_uncertainty: None,
        coverage_factor: 2.0,
        smoothing_s: 0.0,
    }];
    procedure.conditions.statuses =
        vec![StatusCondition { channel: "status".into(), failure_mask: 8.0, valid_mask: 1.0, allowed: None }];
    let integrity = Integrity {
        gaps: 1,
        missing_samples: 1,
        duplicate_timestamps: 1,
        backward_timestamps: 1,
        non_finite: 1,
        unparsable: 1,
        outliers: 1,
        saturated: 1,
        stuck: 1,
        repeated: 1,
        timestamp_jitter_s: Some(1.0),
        ..Integrity::default()
    };
    let far = Extreme { value: 99.0, time_s: 1.0 };
    let track = StabilityFacts {
        usable: 10,
        unusable: 1,
        mean: 50.0,
        raw_min: 0.0,
        raw_max: 99.0,
        smooth_min: Extreme { value: 0.0, time_s: 0.0 },
        smooth_max: far,
        share_outside: 0.5,
        steepest_deg_c_per_h: Some(1.0),
        smoothing_s: 60.0,
    };
    let keys = [StabilityKey::temperature(0), StabilityKey::supply(0), StabilityKey::range(0)];
    let stability: BTreeMap<StabilityKey, StabilityFacts> = keys.map(|key| (key, track.clone())).into();
    let mut status = StatusTrack::new(&procedure.conditions.statuses[0]);
    status.push(&[0.0, 8.0], 0.0, 1.0);
    let statuses = [status];
    let warm_up = [WarmUpFact {
        channel: "rate".into(),
        residual_deg_h: 10.0,
        time_constant_s: 600.0,
        significance: 50.0,
        bias_uncertainty_deg_h: 0.001,
    }];
    let limits: EffectiveLimits = effective(
        &load(&root("procedures/static-bias.toml")).unwrap(),
        Some(&load_limits(&root("procedures/limits/sample-unit.toml")).unwrap()),
    );
    let gyro = GyroFact {
        channel: "rate".into(),
        mean_deg_h: -12.4,
        earth_deg_h: Some((12.47, 1e-4)),
        tau0_s: 1.0,
        deviations: vec![(1.0, 1e-6), (2.0, 1e-6)],
        longest_stretch_s: 36_000.0,
        angle_random_walk: Some(0.002),
        quantization_step_deg_h: Some(1.0),
        bias_step: Some(BiasStep { time_s: 1.0, size_deg_h: 1.0, significance: 20.0 }),
        noise_change: Some(NoiseChange { ratio: 2.0, loudest_s: 1.0, quietest_s: 2.0 }),
        tails: Some(TailShape {
            samples: 100_000,
            excess_kurtosis: -0.5,
            explained: 0.0,
            sigma: 3.0,
            beyond: 0,
            expected_beyond: 270.0,
        }),
        ..GyroFact::default()
    };
    let columns = [ColumnFact { channel: "rate".into(), name: "rate_deg_s".into(), unit: None }];
    procedure.temperature_test =
        load(&root("procedures/temperature-ramp.toml")).unwrap().value.temperature_test;
    let ramp = |kind, from_s: f64| Segment {
        kind,
        from_s,
        to_s: from_s + 3600.0,
        begins_deg_c: 0.0,
        ends_deg_c: 10.0,
        rate_deg_c_h: 10.0,
        rate_uncertainty_deg_c_h: 0.1,
    };
    let schedule = Schedule {
        segments: vec![
            ramp(SegmentKind::Heating, 0.0),
            ramp(SegmentKind::Cooling, 3600.0),
            ramp(SegmentKind::Dwell, 7200.0),
        ],
        reached: Span { low: 0.0, high: 70.0 },
        last_deg_c: 0.0,
        temperature: vec![],
        command: None,
        missing: 0.0,
    };
    let bench = Bench {
        name: Some("TABLE-3".into()),
        releases_for_s: None,
        released_within_s: Some(86400.0),
        check: "bench-check".into(),
    };
    let records = judge_all(&Facts {
        procedure: &procedure,
        integrity: &integrity,
        rows: 1000,
        sample_interval_s: 1.1,
        clock_notes: &[],
        has_stamps: true,
        usable_s: 1.0,
        longest_gap_s: 100.0,
        stability: &stability,
        statuses: &statuses,
        warm_up: &warm_up,
        gyros: &[gyro],
        limits: &limits,
        thermometers: &[],
        columns: &columns,
        duration_s: 1e9,
        stated_serials: &["SN-2"],
        serial: Some("SN-1"),
        serial_of_recording: false,
        schedule: Some(&schedule),
        today: chrono::NaiveDate::from_ymd_opt(2100, 1, 1).unwrap(),
        on_bench: Some(OnBench { bench: &bench, station: None, files: &[], now: sagnac::moment::now() }),
        bench_checks: None,
        checks: &CheckLog::default(),
    });
    let kinds: BTreeSet<&str> = records.iter().filter_map(|c| c.id.split('.').next()).collect();
    // One kind a condition, eleven more of faults, three more of the schedule.
    assert_eq!(kinds.len(), ALL_CONDITIONS.len() - 2 + 12 + 4, "{kinds:?}");
    let mut keys: BTreeSet<String> = kinds.iter().map(|k| format!("condition.{k}")).collect();
    for c in &records {
        keys.extend(c.observed.keys().map(|name| format!("observed.{name}")));
        keys.extend([&c.message, &c.requirement].into_iter().flatten().map(|n| n.id.to_string()));
        let requirement = c.requirement.as_ref().map(|r| r.say(Lang::En)).unwrap_or_default();
        assert!(!requirement.is_empty() && !requirement.contains('{'), "{}: {requirement}", c.id);
        assert_eq!(requirement, c.required);
    }
    assert!(missing(keys.clone()).is_empty(), "{:?}", missing(keys));
}
