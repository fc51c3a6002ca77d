//! What may be identified in a record, and how clearly it must show.

use super::claims::SlowPrices;
use crate::noise::composite::Sampling;
use crate::noise::data::NoiseType;

/// What an identification may find, and how clearly it must show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// How samples were taken.
    pub sampling: Sampling,
    /// Whether Markov processes, quasi-periodic disturbances and a filter of the output are searched for. Without them
    /// the terms are N, B, K, Q and R.
    pub processes: bool,
    /// Whether parts count that bend at the edge of a range that was cut. They may be what was cut off, so that they are
    /// not claimed; whether anything describes the range is asked with them.
    pub parts_at_edge: bool,
    /// When N, B, K, Q and R are claimed.
    pub standard: StandardThresholds,
    /// When everything else is accepted.
    pub process_thresholds: ProcessThresholds,
}

impl Default for Options {
    /// Every kind of term; samples that average the rate over their interval.
    fn default() -> Self {
        Options {
            sampling: Sampling::default(),
            processes: true,
            parts_at_edge: false,
            standard: StandardThresholds::default(),
            process_thresholds: ProcessThresholds::default(),
        }
    }
}

impl Options {
    /// N, B, K, Q and R only, of samples that average the rate over their interval.
    pub fn standard_terms() -> Options {
        Options { processes: false, ..Options::default() }
    }
}

/// Gains in 2 ln L from which N, B, K, Q and R are claimed.
///
/// N and Q are claimed when twice the log-likelihood is larger by their threshold than that of the best model without
/// them, all other terms refitted; flicker, random walk and ramp by comparison of their sets ([`SlowPrices`]). Set so that
/// fewer than 7 % of records claim anything absent (validated in the identification study).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandardThresholds {
    /// Threshold of 2 Δ ln L for N.
    pub white: f64,
    /// Threshold of 2 Δ ln L for Q.
    pub quantization: f64,
    /// Prices of the slow terms.
    pub slow: SlowPrices,
}

impl Default for StandardThresholds {
    fn default() -> Self {
        StandardThresholds { white: 4.0, quantization: 11.0, slow: SlowPrices::default() }
    }
}

impl StandardThresholds {
    /// 2 Δ ln L that a term of some relative uncertainty needs against the best model without it.
    pub fn of(&self, term: NoiseType, relative_sigma: f64) -> f64 {
        self.slow.against_rival(term, relative_sigma).unwrap_or(match term {
            NoiseType::Quantization => self.quantization,
            _ => self.white,
        })
    }
}

/// Gains in 2 ln L from which a part is accepted, what was searched over counted. Calibrated by simulation of units
/// with N, B, K, Q and R alone (validated in the identification study).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProcessThresholds {
    /// A filter of the output.
    pub filter: f64,
    /// A filter beside a Markov process that together make N uncertain.
    pub filter_confounded: f64,
    /// A Markov process. More than for a filter: white noise behind a filter is a Markov process as well, and is to be
    /// called by its simpler name.
    pub markov: f64,
    /// What quantisation costs beside a filter. Both together imitate a short Markov process with a white part, one rising
    /// where the other falls, and N would then be the level of both: few outputs are so, and the two must show clearly.
    pub quantization_beside_filter: f64,
    /// What quantisation costs beside a Markov process.
    pub quantization: f64,
    /// What the claim of quantisation needs where it makes N uncertain. More than the choice of structure: a process
    /// without quantisation is to be told from a filter with it all the same.
    pub quantization_confounded: f64,
    /// A quasi-periodic disturbance, beside twice the logarithm of the resolved places searched.
    pub quasi_periodic: f64,
}

impl Default for ProcessThresholds {
    fn default() -> Self {
        ProcessThresholds {
            filter: 14.0,
            filter_confounded: 20.0,
            markov: 17.0,
            quantization_beside_filter: 20.0,
            quantization: 11.0,
            quantization_confounded: 25.0,
            quasi_periodic: 14.0,
        }
    }
}
