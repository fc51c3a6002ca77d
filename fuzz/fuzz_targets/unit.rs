//! The unit parser, and the factors between what it gives.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::units::Unit;

fuzz_target!(|text: &str| {
    sagnac_fuzz::watched(text.len(), || {
        let (Ok(unit), Ok(rate)) = (Unit::parse(text), Unit::parse("deg/h")) else { return };
        if let Ok((factor, offset)) = unit.affine_to(&rate) {
            assert!(factor.is_finite() && offset.is_finite(), "{text}");
        }
        let _ = sagnac::recording::column_inference::infer(text, Some(text));
    });
});
