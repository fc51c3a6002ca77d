//! An explanation: which effect a model lacks that a recording has.
//!
//! `cargo run --example explain`

use sagnac::{Lang, Model};

/// Runs the example from the folder of the checkout.
pub fn main() -> Result<(), sagnac::Error> {
    // A recording whose bias jumps after half an hour, against a model of the gyro without the jump.
    let recording = Model::load("samples/model-step.toml")?.simulate(7)?;
    let model = Model::load("samples/model-static.toml")?;
    let why = sagnac::explain(&recording, &model)?;
    println!("{}", why.summary(Lang::En));
    for effect in why.effects() {
        println!("{}: {:?}", effect.kind, effect.parameters.keys());
    }
    println!("{}", why.augmented().to_toml());
    Ok(())
}
