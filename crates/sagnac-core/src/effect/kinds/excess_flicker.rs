//! Flicker noise that differs from the claimed one.

use crate::effect::Param;

pub struct ExcessFlicker;

static PARAMS: [Param; 1] = [Param::reported("B_deg_h", "deg/h", 0.0, 1e4).corrects_claim()];

describe! {
    ExcessFlicker, "excess_flicker", Spectrum in Frequency, needs [],
    confusers ["markov_long", "excess_rrw", "unobserved_driver"]
}

frees! { ExcessFlicker, Flicker, b, course false }
