//! A recording tested by the library under a procedure and the limits of the samples.

use sagnac::acceptance::{Request, RunError, execute};
use sagnac::config::procedure::{Loaded, Procedure, effective, load_limits};
use sagnac::record::{RunRecord, UnitUnderTest};
use std::path::Path;

/// The record of the run; the time of it is always the same.
pub fn tested(procedure: &Loaded<Procedure>, recording: &Path) -> Result<RunRecord, RunError> {
    let limits = load_limits(Path::new(&super::limits())).unwrap();
    let effective = effective(procedure, Some(&limits));
    let source = sagnac::ingest::open(recording)?;
    let request = Request {
        kind: sagnac::record::RunKind::Run,
        procedure: &procedure.value,
        procedure_record: Some(procedure.record(Some(&limits))),
        limits: &effective,
        source: &source,
        use_stamps: true,
        unit: UnitUnderTest { serial: Some("SN-0001".into()), ..UnitUnderTest::default() },
        serial_of_recording: false,
        operator: None,
        station: None,
        now: chrono::DateTime::from_timestamp(1_795_000_000, 0).unwrap(),
        taus: None,
        exact: false,
        bench_checks: None,
    };
    execute(&request, &mut |_, _| {}).map(|outcome| outcome.record)
}
