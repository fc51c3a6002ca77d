//! An own measurand: a quantity that the catalogue lacks, computed from the evidence of a gyro.
//!
//! `cargo run --example own_measurand`

use sagnac::Recording;
use sagnac::estimate::{Estimate, Spread};
use sagnac::measurand::{GyroEvidence, Measurand, Options};

/// Largest sample less smallest, deg/h. A property of this recording and not of the unit, hence without uncertainty.
struct PeakToPeak;

impl Measurand for PeakToPeak {
    fn ids(&self) -> &'static [&'static str] {
        &["peak_to_peak"]
    }

    fn evaluate(&self, _id: &str, gyro: &GyroEvidence, _options: &Options) -> Option<Estimate> {
        let range = gyro.digest.max - gyro.digest.min;
        let estimate =
            Estimate::measured("peak_to_peak", &gyro.channel, range, "deg/h", Spread::Unknown, "range");
        range.is_finite().then_some(estimate)
    }
}

/// Runs the example from the folder of the checkout.
pub fn main() -> Result<(), sagnac::Error> {
    let recording = Recording::open("samples/unit-pass.csv")?;
    let noise = sagnac::noise::identify(&recording.rate("rate_deg_h")?)?;
    let own = PeakToPeak.evaluate("peak_to_peak", noise.evidence(), &Options { remove_earth_rate: false });
    if let Some(own) = own {
        println!("{}: {:?} {}", own.id, own.value, own.unit);
    }
    Ok(())
}
