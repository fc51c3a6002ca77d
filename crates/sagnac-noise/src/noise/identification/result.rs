//! Noise identified in one channel.

use super::claims::WHITTLE_METHOD;
use super::joint::{Extras, Plateau};
use super::misfit::Misfit;
use crate::estimate::Estimate;
use crate::noise::composite::{Composite, Damped, Described};
use crate::noise::data::NoiseType;
use crate::noise::model::NoiseModel;

/// The identified noise of one channel: claimed terms with intervals or upper limits, the models they make, and their fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// Channel.
    pub channel: String,
    /// Name of the method.
    pub method: &'static str,
    /// The claimed terms, refitted together; others 0.
    pub model: NoiseModel,
    /// The model that describes the record best, terms included that are needed but not certain. For predictions,
    /// for the uncertainty of other quantities, for drawing.
    pub supported: NoiseModel,
    /// The maximum with every term allowed.
    pub full: NoiseModel,
    /// Terms claimed, in the order of [`TERMS`](crate::noise::model::TERMS).
    pub claimed: Vec<NoiseType>,
    /// True when low-frequency noise is present that could be flicker, random walk or a ramp, so that no single one
    /// of them is claimed.
    pub ambiguous: bool,
    /// 2 Δ ln L of each of [`TERMS`](crate::noise::model::TERMS) against the best model without it.
    pub likelihood_ratios: [f64; 5],
    /// N of the white noise alone with its interval, or its upper limit.
    pub angle_random_walk: Estimate,
    /// The level that is read as angle random walk where a process is white there beside the white noise
    /// ([`super::Plateau`]); `None`: it is that of the white noise.
    pub white_plateau: Option<Estimate>,
    /// Averaging times that this level is read at.
    pub plateau: Option<Plateau>,
    /// B of the 1/f law with its interval, or its upper limit. The Allan floor is 0.664 B.
    pub bias_instability: Estimate,
    /// K with its interval, or its upper limit.
    pub rate_random_walk: Estimate,
    /// R with its interval, or the upper limit of its size.
    pub rate_ramp: Estimate,
    /// Q with its interval, or its upper limit.
    pub quantization: Estimate,
    /// Covariance of the coefficients of `supported`, order of [`TERMS`](crate::noise::model::TERMS); zeros for absent terms.
    pub covariance: [[f64; 5]; 5],
    /// How well `supported` fits.
    pub misfit: Misfit,
    /// The best description with every kind of term, and the covariance of its parameters. For predictions, residuals
    /// and drawing; its N, B, K, R and Q are those of `supported`, or those with quantisation where that is suspected.
    pub described: Described,
    /// The maximum with N, B, K and Q allowed beside everything that was found: [`Identification::full`] with the rest.
    /// For uncertainties.
    pub allowed: Composite,
    /// Markov processes found.
    pub markov: Vec<MarkovFound>,
    /// Quasi-periodic disturbances found, the strongest first.
    pub quasi_periodic: Vec<QuasiPeriodicFound>,
    /// −3 dB cut-off of the measurement, Hz, where the record shows a filter.
    pub cutoff: Option<Estimate>,
    /// A long Markov process that is not told from the flicker or random walk that was claimed.
    pub long_process: Option<Damped>,
    /// Highest frequency that the model rests on, Hz; `None`: all.
    pub highest_hz: Option<f64>,
    /// Where the search for further parts ended; `None` where a second search might end elsewhere.
    pub(in crate::noise) searched: Option<Extras>,
}

/// A first-order Markov process that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkovFound {
    /// Standard deviation, deg/h.
    pub sigma: Estimate,
    /// Correlation time, s.
    pub correlation_time: Estimate,
}

/// A quasi-periodic disturbance that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct QuasiPeriodicFound {
    /// Rms, deg/h.
    pub amplitude: Estimate,
    /// Centre frequency, Hz.
    pub frequency: Estimate,
    /// Coherence time, s: 1/(π × full width at half power).
    pub coherence_time: Estimate,
}

/// Id, unit in the order of [`TERMS`](crate::noise::model::TERMS).
pub(in crate::noise) const IDS: [(&str, &str); 5] = [
    ("angle_random_walk", "deg/sqrt(h)"),
    ("bias_instability", "deg/h"),
    ("rate_random_walk", "deg/h/sqrt(h)"),
    ("quantization", "arcsec"),
    ("rate_ramp", "deg/h/h"),
];
impl Identification {
    /// Angle random walk by its meaning: the level that is read, white noise with every process that is white there.
    pub fn read_angle_random_walk(&self) -> &Estimate {
        self.white_plateau.as_ref().unwrap_or(&self.angle_random_walk)
    }

    /// The same, to be changed.
    pub fn read_angle_random_walk_mut(&mut self) -> &mut Estimate {
        self.white_plateau.as_mut().unwrap_or(&mut self.angle_random_walk)
    }

    /// The estimates in the order of the contract: N, B, K, R, Q.
    pub fn estimates(&self) -> [&Estimate; 5] {
        [
            &self.angle_random_walk,
            &self.bias_instability,
            &self.rate_random_walk,
            &self.rate_ramp,
            &self.quantization,
        ]
    }

    /// The same, to be changed.
    pub fn estimates_mut(&mut self) -> [&mut Estimate; 5] {
        [
            &mut self.angle_random_walk,
            &mut self.bias_instability,
            &mut self.rate_random_walk,
            &mut self.rate_ramp,
            &mut self.quantization,
        ]
    }

    /// Every estimate there is, those of Markov processes, quasi-periodic disturbances and the bandwidth too.
    pub(in crate::noise) fn every_estimate_mut(&mut self) -> Vec<&mut Estimate> {
        let mut out = vec![
            &mut self.angle_random_walk,
            &mut self.bias_instability,
            &mut self.rate_random_walk,
            &mut self.rate_ramp,
            &mut self.quantization,
        ];
        out.extend(self.markov.iter_mut().flat_map(|m| [&mut m.sigma, &mut m.correlation_time]));
        for q in &mut self.quasi_periodic {
            out.extend([&mut q.amplitude, &mut q.frequency, &mut q.coherence_time]);
        }
        out.extend(&mut self.white_plateau);
        out.extend(&mut self.cutoff);
        out
    }

    /// The estimates in the order of [`TERMS`](crate::noise::model::TERMS): N, B, K, Q, R.
    pub(in crate::noise) fn estimates_mut_by_term(&mut self) -> [&mut Estimate; 5] {
        [
            &mut self.angle_random_walk,
            &mut self.bias_instability,
            &mut self.rate_random_walk,
            &mut self.quantization,
            &mut self.rate_ramp,
        ]
    }

    /// True when the term is claimed.
    pub fn claims(&self, term: NoiseType) -> bool {
        self.claimed.contains(&term)
    }

    /// The result for a channel of which nothing was identified.
    pub fn empty(channel: &str) -> Identification {
        let none = |i: usize| Estimate::not_identifiable(IDS[i].0, channel, None, IDS[i].1, WHITTLE_METHOD);
        Identification {
            channel: channel.to_owned(),
            method: WHITTLE_METHOD,
            model: NoiseModel::default(),
            supported: NoiseModel::default(),
            full: NoiseModel::default(),
            claimed: vec![],
            ambiguous: false,
            likelihood_ratios: [0.0; 5],
            angle_random_walk: none(0),
            white_plateau: None,
            plateau: None,
            bias_instability: none(1),
            rate_random_walk: none(2),
            quantization: none(3),
            rate_ramp: none(4),
            covariance: [[0.0; 5]; 5],
            misfit: Misfit::none(),
            described: Described::default(),
            allowed: Composite::default(),
            markov: vec![],
            quasi_periodic: vec![],
            cutoff: None,
            long_process: None,
            highest_hz: None,
            searched: None,
        }
    }
}
