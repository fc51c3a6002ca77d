//! Angle random walk, flicker noise or rate random walk that differs from the claimed one: its coefficient is unconstrained.

use crate::effect::{Param, Spectrum, SpectrumAct};
use crate::noise::data::NoiseType;

pub struct ExcessArw;

pub struct ExcessFlicker;

pub struct ExcessRrw;

static ARW_PARAMS: [Param; 1] = [Param::reported("N_deg_rt_h", "deg/√h", 0.0, 1e3).corrects_claim()];
static FLICKER_PARAMS: [Param; 1] = [Param::reported("B_deg_h", "deg/h", 0.0, 1e4).corrects_claim()];
static RRW_PARAMS: [Param; 1] = [Param::reported("K_deg_h_rt_h", "deg/h/√h", 0.0, 1e4).corrects_claim()];

describe! {
    ExcessArw, "excess_arw", Spectrum in Frequency, needs [],
    confusers [MarkovShort, NoiseVarianceTime, OutlierBursts],
    params ARW_PARAMS, properties [family Spectrum]
}

describe! {
    ExcessFlicker, "excess_flicker", Spectrum in Frequency, needs [],
    confusers [MarkovLong, ExcessRrw, UnobservedDriver],
    params FLICKER_PARAMS, properties [family Spectrum]
}

describe! {
    ExcessRrw, "excess_rrw", Spectrum in Frequency, needs [],
    confusers [UnobservedDriver, MarkovLong, ExcessFlicker, BiasStep],
    params RRW_PARAMS, properties [family Spectrum]
}

impl Spectrum for ExcessArw {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Unconstrains(NoiseType::AngleRandomWalk)
    }
}

impl Spectrum for ExcessFlicker {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Unconstrains(NoiseType::Flicker)
    }
}

impl Spectrum for ExcessRrw {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Unconstrains(NoiseType::RateRandomWalk)
    }

    fn has_course(&self) -> bool {
        true
    }
}
