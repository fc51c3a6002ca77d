//! A run: a procedure with limits on a recording, and what became of each limit.
//!
//! `cargo run --example run`

use sagnac::estimate::Verdict;
use sagnac::export::{Csv, Json};
use sagnac::{Lang, Procedure, Recording, UnitUnderTest};

/// Runs the example from the folder of the checkout.
pub fn main() -> Result<(), sagnac::Error> {
    let recording = Recording::open("samples/unit-fail.csv")?;
    let procedure = Procedure::load("procedures/static-bias.toml")?
        .with_limits("procedures/limits/sample-unit.toml")?
        .operator("A. Ivanova");
    for warning in procedure.warnings() {
        eprintln!("{warning}");
    }
    let result = procedure.run(&recording, &UnitUnderTest::with_serial("SN-0001"))?;
    println!("{:?}", result.verdict());
    for row in &result.record().measurands {
        if row.verdict != Verdict::None {
            println!("  {:30} {:?} {} {:?}", row.id, row.value, row.unit, row.verdict);
        }
    }
    result.write("target/example-run", &[&Json, &Csv], Lang::En)
}
