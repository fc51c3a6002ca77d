//! The noise of a file: terms with their intervals, the Allan deviation, spectral lines.
//!
//! `cargo run --example noise`

use sagnac::Recording;

/// Runs the example from the folder of the checkout.
pub fn main() -> Result<(), sagnac::Error> {
    let recording = Recording::open("samples/unit-pass.csv")?;
    let noise = sagnac::noise::identify(&recording.rate("rate_deg_h")?)?;
    for term in noise.terms() {
        match (term.value, term.interval95(), term.upper_limit) {
            (Some(value), Some(i), _) => {
                println!("{:20} {value:.2e} {} (95 %: {:.2e} to {:.2e})", term.id, term.unit, i.low, i.high);
            }
            (_, _, Some(limit)) => println!("{:20} < {:.2e} {} (95 %)", term.id, limit.value, term.unit),
            _ => println!("{:20} not resolved", term.id),
        }
    }
    println!("\n  tau, s   sigma, deg/h");
    for octave in noise.allan() {
        let tau_s = octave.point.m as f64 * noise.evidence().tau0_s;
        println!("{tau_s:8} {:.3e}", octave.point.deviation);
    }
    for line in noise.lines() {
        println!("line at {:.4} Hz, amplitude {:.2e} deg/h", line.frequency_hz, line.amplitude_deg_h);
    }
    Ok(())
}
