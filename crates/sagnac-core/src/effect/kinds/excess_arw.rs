//! Angle random walk that differs from the claimed one.

use crate::effect::{Family, Param};

pub struct ExcessArw;

static PARAMS: [Param; 1] = [Param::reported("N_deg_rt_h", "deg/√h", 0.0, 1e3).corrects_claim()];

describe! {
    ExcessArw, "excess_arw", Spectrum in Frequency, needs [],
    confusers ["markov_short", "noise_variance_time", "outlier_bursts"],
    with {
        fn family(&self) -> Option<Family> {
            Some(Family::Spectrum)
        }
    }
}

frees! { ExcessArw, AngleRandomWalk, n, course false }
