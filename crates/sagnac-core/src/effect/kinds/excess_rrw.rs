//! Rate random walk that differs from the claimed one.

use crate::effect::{Family, Param};

pub struct ExcessRrw;

static PARAMS: [Param; 1] = [Param::reported("K_deg_h_rt_h", "deg/h/√h", 0.0, 1e4).corrects_claim()];

describe! {
    ExcessRrw, "excess_rrw", Spectrum in Frequency, needs [],
    confusers ["unobserved_driver", "markov_long", "excess_flicker", "bias_step"],
    with {
        fn family(&self) -> Option<Family> {
            Some(Family::Spectrum)
        }
    }
}

frees! { ExcessRrw, RateRandomWalk, k, course true }
