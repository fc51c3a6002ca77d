//! Flicker noise that differs from the claimed one.

use crate::effect::{Family, Param};

pub struct ExcessFlicker;

static PARAMS: [Param; 1] = [Param::reported("B_deg_h", "deg/h", 0.0, 1e4).corrects_claim()];

describe! {
    ExcessFlicker, "excess_flicker", Spectrum in Frequency, needs [],
    confusers ["markov_long", "excess_rrw", "unobserved_driver"],
    with {
        fn family(&self) -> Option<Family> {
            Some(Family::Spectrum)
        }
    }
}

frees! { ExcessFlicker, Flicker, b, course false }
