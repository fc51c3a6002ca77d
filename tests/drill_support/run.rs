//! A spoilt recording under the static procedure, by the library.

use sagnac::procedure::{effective, load, load_limits};
use sagnac::record::{RunRecord, UnitUnderTest};
use sagnac::run::{Request, execute};
use std::path::Path;

/// The record, or what was said instead.
pub fn run(folder: &Path, recording: &Path, change: impl Fn(String) -> String) -> Result<RunRecord, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let shipped = std::fs::read_to_string(root.join("procedures/static-bias.toml")).unwrap();
    let own = folder.join("procedure.toml");
    std::fs::write(&own, change(shipped)).unwrap();
    let procedure = load(&own).map_err(|e| e.to_string())?;
    let limits = load_limits(&root.join("procedures/limits/sample-unit.toml")).unwrap();
    let effective = effective(&procedure, Some(&limits));
    let source = sagnac::ingest::open(recording).map_err(|e| e.to_string())?;
    let request = Request {
        kind: "run",
        procedure: &procedure.value,
        procedure_record: Some(procedure.record(Some(&limits))),
        limits: &effective,
        source: &source,
        use_stamps: true,
        unit: UnitUnderTest { serial: Some("SN-0001".into()), ..UnitUnderTest::default() },
        operator: None,
        station: None,
        now: chrono::DateTime::from_timestamp(1_795_000_000, 0).unwrap(),
        taus: None,
        exact: false,
    };
    execute(&request, &mut |_, _| {}).map(|o| o.record).map_err(|e| e.to_string())
}
