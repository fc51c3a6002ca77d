//! What the fuzz targets share: files made of the input, an eye on memory, an analysis in memory.

use peak_alloc::PeakAlloc;
use sagnac::acceptance::{Outcome, Request, analysis, execute};
use sagnac::config::procedure::EffectiveLimits;
use sagnac::figure::Figure;
use sagnac::ingest::{ReadOptions, Source, open, open_with};
use sagnac::record::{RunRecord, UnitUnderTest};
use sagnac::recording::column_inference::infer;
use sagnac::recording::{Channel, ColumnRef, Role};
use sagnac::units::Unit;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Bytes that a reader may use whatever the input: blocks on their way, windows of the unpackers.
const BASE: usize = 192 << 20;
/// Bytes that a reader may use for each byte of the input.
const PER_BYTE: usize = 50;

/// Runs a reader of `input` bytes and asserts that it kept to its memory.
pub fn watched<T>(input: usize, reader: impl FnOnce() -> T) -> T {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let value = reader();
    let used = MEMORY.peak_usage().saturating_sub(before);
    assert!(used <= BASE + PER_BYTE * input, "{used} bytes for an input of {input}");
    value
}

/// Writes the input into a file and hands its path over.
pub fn with_file(name: &str, bytes: &[u8], f: impl FnOnce(&Path)) {
    let Ok(folder) = tempfile::tempdir() else { return };
    let path = folder.path().join(name);
    if std::fs::write(&path, bytes).is_ok() {
        f(&path);
    }
}

/// Opens a file as told and reads all its columns.
pub fn read_all(path: &Path, options: &ReadOptions, input: usize) {
    watched(input, || {
        let Ok(source) = open_with(path, options) else { return };
        let wanted: Vec<usize> =
            (0..source.columns().len()).filter(|i| source.columns()[*i].numeric).collect();
        let mut rows = 0u64;
        let facts = source.read(&wanted, &mut |block| {
            assert!(block.columns.iter().all(|c| c.len() == block.rows()));
            rows += block.rows() as u64;
            ControlFlow::Continue(())
        });
        if let Ok(Some(facts)) = facts {
            assert!(wanted.is_empty() || facts.rows == rows, "{} rows told, {rows} delivered", facts.rows);
        }
    });
}

/// Parses a file of keys; whatever it says must be sayable.
pub fn file_of_keys<T>(
    bytes: &[u8],
    parse: impl Fn(&[u8]) -> Result<T, sagnac::config::procedure::Problems>,
) {
    watched(bytes.len(), || {
        if let Err(problems) = parse(bytes) {
            assert!(!problems.list.is_empty());
            assert!(problems.list.iter().all(|p| !p.to_string().is_empty()));
        }
    });
}

fn outcome(source: &Source) -> Option<Outcome> {
    let unit = Unit::parse("deg/h").ok()?;
    let mut channels: Vec<Channel> = vec![];
    for (i, column) in source.columns().iter().enumerate().filter(|(_, c)| c.numeric).take(3) {
        let guessed = infer(&column.name, column.unit.as_deref());
        let time = guessed.role == Role::Time && !channels.iter().any(|c| c.role == Role::Time);
        let (role, unit) = match guessed.role {
            Role::Time if time => (Role::Time, guessed.unit),
            Role::Temperature => (Role::Temperature, guessed.unit),
            _ => (Role::Rate, unit.clone()),
        };
        channels.push(Channel {
            id: format!("c{i}"),
            column: ColumnRef::Position(i + 1),
            role,
            unit,
            scale: 1.0,
        });
    }
    let use_stamps = channels.iter().any(|c| c.role == Role::Time);
    let procedure = analysis::procedure(channels, Some(10.0), 0.0);
    let limits = EffectiveLimits::default();
    let request = Request {
        kind: sagnac::record::RunKind::Analyze,
        procedure: &procedure,
        procedure_record: None,
        limits: &limits,
        source,
        use_stamps,
        unit: UnitUnderTest::default(),
        operator: None,
        station: None,
        now: chrono::DateTime::from_timestamp(1_795_000_000, 0)?,
        taus: None,
        exact: false,
    };
    execute(&request, &mut |_, _| {}).ok()
}

/// Analyses a file; a number that is none would be a null or a word in the result.
pub fn analyse(path: &Path) {
    let Some(outcome) = open(path).ok().and_then(|source| outcome(&source)) else { return };
    for m in &outcome.record.measurands {
        assert!(m.value.is_none_or(f64::is_finite), "{} {:?}", m.id, m.value);
    }
    for (name, table) in &outcome.tables {
        let bad = table.split([',', '\n']).any(|w| ["NaN", "inf", "-inf"].contains(&w));
        assert!(!bad, "{name}:\n{table}");
    }
}

/// A record and its figures, for templates.
pub fn sample() -> (&'static RunRecord, &'static [Figure]) {
    static SAMPLE: OnceLock<Outcome> = OnceLock::new();
    let outcome = SAMPLE.get_or_init(|| {
        let rate: Vec<f64> = (0..2000u32).map(|i| f64::from(i.wrapping_mul(2_654_435_761) >> 16)).collect();
        let columns = vec![("rate_deg_h".to_owned(), rate)];
        let source = Source::from_columns("sample", columns, 500).expect("columns of one length");
        outcome(&source).expect("a sound recording")
    });
    (&outcome.record, &outcome.figures)
}
