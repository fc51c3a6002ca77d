//! A report in Russian: one HTML page, and Markdown with its figures.
//!
//! `cargo run --example russian_report`

use sagnac::export::{Html, Markdown};
use sagnac::{Lang, Procedure, Recording, UnitUnderTest};

/// Runs the example from the folder of the checkout.
pub fn main() -> Result<(), sagnac::Error> {
    let recording = Recording::open("samples/scale-factor-pass.csv")?;
    let unit = UnitUnderTest { family: Some("ВОГ-1".into()), ..UnitUnderTest::with_serial("SN-1") };
    let result = Procedure::load("procedures/scale-factor.toml")?.run(&recording, &unit)?;
    result.write("target/example-russian", &[&Html, &Markdown], Lang::Ru)?;
    println!("target/example-russian/report.html");
    Ok(())
}
