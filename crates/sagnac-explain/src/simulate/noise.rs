//! The noise of a claim with the effects that change its spectrum.

use super::SimulateError;
use super::low_pass::Filtering;
use super::seed::stream;
use super::shape::{SIDE, filtered, taps};
use crate::claim::{Claim, Stated};
use crate::effect::{Drivers, LowPass, Model};
use crate::message::note;
use crate::noise::composite::Composite;
use crate::noise::data::NoiseType;
use crate::noise::model::NoiseModel;
use crate::noise::simulate::{Setup, Simulator};
use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};

/// The noise model of a claim, its effects on the spectrum composed.
pub(super) fn composed(claim: &Claim) -> Result<Composite, SimulateError> {
    let mut noise = Composite::from(claim.noise);
    for stated in &claim.effects {
        let Model::Spectrum(spectrum) = stated.effect.model() else { continue };
        match spectrum.claimed_parameters(&stated.values) {
            Some(fitted) => spectrum.compose(&fitted, 1.0 / claim.sample_rate_hz, &mut noise),
            // It is stated as a course.
            None if course_of(stated) => {}
            None => {
                let note = note!("simulate.no_parameters", kind = stated.effect.kind());
                return Err(note.into());
            }
        }
    }
    Ok(noise)
}

/// The filter of samples that a claim states.
pub(super) fn low_pass(claim: &Claim) -> Option<LowPass> {
    claim.effects.iter().find_map(|stated| {
        let Model::Spectrum(spectrum) = stated.effect.model() else { return None };
        spectrum.low_pass(&spectrum.claimed_parameters(&stated.values)?, 1.0 / claim.sample_rate_hz)
    })
}

/// True for an effect that changes the spectrum where it is fitted, and is a course where it is stated.
fn course_of(stated: &Stated) -> bool {
    let one = Drivers { samples: 1, dt_s: 1.0, ..Drivers::default() };
    stated.effect.claimed_course(&stated.values, &one).is_some()
}

/// A running noise, without the rounding of the angle.
pub(super) struct Noise {
    rest: Simulator,
    shaped: Vec<Shaped>,
    filtering: Option<Filtering>,
}

/// A term whose density is made that of the claim.
struct Shaped {
    simulator: Simulator,
    taps: [f64; SIDE + 1],
    /// What the next block begins with.
    ahead: Vec<f64>,
}

impl Noise {
    pub fn new(noise: &Composite, low_pass: Option<LowPass>, seed: u64, dt_s: f64, samples: u64) -> Noise {
        let filtering = low_pass.map(Filtering::new);
        let lead = filtering.as_ref().map_or(0, |f| f.lead().min(samples as usize + 2 * SIDE));
        let samples = samples + lead as u64;
        let setup = |tag: u64| Setup::for_record(stream(seed, tag), dt_s, samples);
        let terms = NoiseModel { b: 0.0, k: 0.0, q: 0.0, ..noise.terms };
        let rest = Simulator::of(&Composite { terms, ..noise.clone() }, &setup(1));
        let alone = |term: NoiseType, coefficient: f64, tag: u64| {
            (coefficient != 0.0).then(|| {
                let terms = NoiseModel::default().with(term, coefficient);
                let model = Composite { bandwidth: noise.bandwidth, ..Composite::from(terms) };
                let mut simulator = Simulator::of(&model, &setup(tag));
                let ahead = simulator.take(2 * SIDE);
                Shaped { simulator, taps: taps(term), ahead }
            })
        };
        let flicker = alone(NoiseType::Flicker, noise.terms.b, 2);
        let walk = alone(NoiseType::RateRandomWalk, noise.terms.k, 3);
        let mut out = Noise { rest, shaped: flicker.into_iter().chain(walk).collect(), filtering: None };
        if let Some(mut filtering) = filtering {
            filtering.begin(out.unfiltered(lead));
            out.filtering = Some(filtering);
        }
        out
    }

    /// The next samples, deg/h.
    pub fn take(&mut self, samples: usize) -> Vec<f64> {
        let values = self.unfiltered(samples);
        match &mut self.filtering {
            Some(filtering) => filtering.through(values),
            None => values,
        }
    }

    /// Each term draws from a stream of its own, so that terms are made side by side; they are added up in their order.
    fn unfiltered(&mut self, samples: usize) -> Vec<f64> {
        let Noise { rest, shaped, .. } = self;
        let unshaped = || -> Vec<Vec<f64>> { shaped.par_iter_mut().map(|s| s.unshaped(samples)).collect() };
        let (mut out, terms) = rayon::join(|| rest.take(samples), unshaped);
        for (shaped, values) in self.shaped.iter_mut().zip(terms) {
            filtered(&values, &shaped.taps, &mut out);
            shaped.ahead = values[samples..].to_vec();
        }
        out
    }
}

impl Shaped {
    /// So many samples before the filter, with those at either end that it needs.
    fn unshaped(&mut self, samples: usize) -> Vec<f64> {
        let mut values = std::mem::take(&mut self.ahead);
        values.resize(samples + 2 * SIDE, 0.0);
        self.simulator.fill(&mut values[2 * SIDE..]);
        values
    }
}
