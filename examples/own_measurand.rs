//! An own measurand: a quantity that the catalogue lacks, computed from the evidence of a gyro.
//!
//! `cargo run --example own_measurand`

use sagnac::Recording;
use sagnac::estimate::Spread;
use sagnac::measurand::{Measurand, Options};

/// Largest sample less smallest, deg/h. A property of this recording and not of the unit, hence without uncertainty.
static PEAK_TO_PEAK: Measurand =
    Measurand::at_rest("peak_to_peak", "deg/h", "largest less smallest sample", |m, gyro, _| {
        let range = gyro.digest.max - gyro.digest.min;
        vec![m.measured(&gyro.channel, range, Spread::Unknown, "range")]
    });

/// Runs the example from the folder of the checkout.
pub fn main() -> Result<(), sagnac::Error> {
    let recording = Recording::open("samples/unit-pass.csv")?;
    let noise = sagnac::noise::identify(&recording.rate("rate_deg_h")?)?;
    for own in PEAK_TO_PEAK.evaluate_gyro(noise.evidence(), &Options { remove_earth_rate: false }) {
        println!("{}: {:?} {}", own.id, own.value, own.unit);
    }
    Ok(())
}
