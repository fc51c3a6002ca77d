//! Speed of the parts of a run on a million samples: `cargo bench -p sagnac-benches --bench throughput`.
//! Nothing here passes or fails.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sagnac::acceptance::{Request, analysis, execute};
use sagnac::config::procedure::EffectiveLimits;
use sagnac::ingest::{Source, open};
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::digest::{DigestPlan, RateAccumulator};
use sagnac::noise::family::Estimator;
use sagnac::noise::tau_grid::TauGrid;
use sagnac::record::UnitUnderTest;
use sagnac::recording::{Channel, ColumnRef, Role};
use sagnac::units::Unit;
use sagnac_benches::{TAU0_S, simulated_rate};
use std::fmt::Write;
use std::ops::ControlFlow;

const SAMPLES: usize = 1_000_000;

fn channel(column: &str, role: Role, unit: &str) -> Channel {
    let unit = Unit::parse(unit).expect("a unit");
    Channel { id: column.into(), column: ColumnRef::Name(column.into()), role, unit, scale: 1.0 }
}

fn analyse(source: &Source) -> usize {
    let channels = vec![channel("time_s", Role::Time, "s"), channel("rate_deg_h", Role::Rate, "deg/h")];
    let procedure = analysis::procedure(channels, None, 0.0);
    let request = Request {
        kind: sagnac::record::RunKind::Analyze,
        procedure: &procedure,
        procedure_record: None,
        limits: &EffectiveLimits::default(),
        source,
        use_stamps: true,
        unit: UnitUnderTest::default(),
        serial_of_recording: false,
        operator: None,
        station: None,
        now: chrono::DateTime::UNIX_EPOCH,
        taus: None,
        exact: false,
        bench_checks: None,
    };
    execute(&request, &mut |_, _| {}).expect("an outcome").figures.len()
}

fn throughput(c: &mut Criterion) {
    let rate = simulated_rate(SAMPLES);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("million.csv");
    let mut text = String::from("time_s,rate_deg_h\n");
    for (i, y) in rate.iter().enumerate() {
        let _ = writeln!(text, "{:.2},{y:.6}", i as f64 * TAU0_S);
    }
    std::fs::write(&path, &text).expect("a file");
    let source = open(&path).expect("a recording");
    let mut group = c.benchmark_group("million_samples");
    group.sample_size(10).throughput(Throughput::Elements(SAMPLES as u64));
    group.bench_function("csv", |b| {
        b.iter(|| {
            let mut sum = 0.0;
            let facts = source.read(&[0, 1], &mut |block| {
                sum += block.columns.iter().flatten().sum::<f64>();
                ControlFlow::Continue(())
            });
            (sum, facts.expect("the file").map(|f| f.rows))
        });
    });
    group.bench_function("digest", |b| {
        b.iter(|| {
            let mut digest = RateAccumulator::new(DigestPlan::new(TAU0_S));
            digest.push(&rate, 0, false);
            digest.finish().mean
        });
    });
    group.bench_function("oadev_exact", |b| {
        b.iter(|| {
            let mut allan = AllanAccumulator::new(AllanPlan {
                tau0_s: TAU0_S,
                grid: TauGrid::Octave,
                exact: true,
                estimators: vec![Estimator::Allan],
            });
            allan.push(&rate, 0, false);
            allan.finish().curves.len()
        });
    });
    group.bench_function("analyze", |b| b.iter(|| analyse(&source)));
    group.finish();
}

criterion_group!(benches, throughput);
criterion_main!(benches);
