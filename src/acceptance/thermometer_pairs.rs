//! Rows of two thermometers that are compared: the mean of their difference over the evaluated time.

use super::derived::own_row;
use crate::config::procedure::thermometer_pair::ThermometerPair;
use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::estimate::{Component, Estimate, InputQuantity, Spread};
use crate::i18n::note;
use crate::record::MeasurandRecord;
use crate::recording::{Channel, SampleBlock, Sink};

/// Method of these rows.
const METHOD: &str = "thermometer_pair";
/// Unit of these rows.
const UNIT: &str = "K";
/// Parts of the evaluated time whose means tell the uncertainty of the whole: few, so that what is slow in the readings counts.
const PARTS: usize = 8;
/// Sums that are kept at most, a power of two times the parts: beyond, neighbours are joined.
const MOST_SUMS: usize = 128 * PARTS;

/// Differences of a pair while the recording goes by.
struct Track {
    slots: Option<(usize, usize)>,
    /// The readings before, and the smallest change of each from one to the next: the step of a thermometer that writes few digits.
    last: [f64; 2],
    steps: [f64; 2],
    /// Sum of the differences and their number, one for as many differences as `length`; the last one is not full.
    sums: Vec<(f64, u64)>,
    length: u64,
}

impl Track {
    fn new(slots: Option<(usize, usize)>) -> Track {
        Track { slots, last: [f64::NAN; 2], steps: [f64::INFINITY; 2], sums: vec![], length: 1 }
    }

    fn push(&mut self, readings: [f64; 2]) {
        let [own, other] = readings;
        if !(own - other).is_finite() {
            return;
        }
        for ((reading, last), step) in readings.iter().zip(&self.last).zip(&mut self.steps) {
            let change = (reading - last).abs();
            if change > 0.0 {
                *step = step.min(change);
            }
        }
        self.last = readings;
        self.add(own - other);
    }

    fn add(&mut self, difference: f64) {
        match self.sums.last_mut() {
            Some((sum, count)) if *count < self.length => {
                *sum += difference;
                *count += 1;
            }
            _ => {
                if self.sums.len() == MOST_SUMS {
                    self.length *= 2;
                    let joined = self
                        .sums
                        .chunks(2)
                        .map(|pair| pair.iter().fold((0.0, 0), |(sum, count), (s, n)| (sum + s, count + n)));
                    self.sums = joined.collect();
                }
                self.sums.push((difference, 1));
            }
        }
    }

    fn facts(&self) -> Option<PairFacts> {
        let (sum, count) = self.sums.iter().fold((0.0, 0), |(sum, count), (s, n)| (sum + s, count + n));
        let mean = (count > 0).then(|| sum / count as f64)?;
        // Whole sums only: a part with few differences would scatter more than the others.
        let full: Vec<f64> =
            self.sums.iter().filter(|(_, n)| *n == self.length).map(|(s, n)| s / *n as f64).collect();
        let parts: Vec<f64> = match full.len() / PARTS {
            0 => vec![],
            size => {
                let means = full.chunks_exact(size).map(|part| part.iter().sum::<f64>() / size as f64);
                means.take(PARTS).collect()
            }
        };
        let of_parts = parts.iter().sum::<f64>() / PARTS as f64;
        let squares: f64 = parts.iter().map(|m| (m - of_parts).powi(2)).sum();
        let standard = (parts.len() == PARTS).then(|| (squares / ((PARTS * (PARTS - 1)) as f64)).sqrt());
        let steps = self.steps.map(|s| if s.is_finite() { s } else { 0.0 });
        Some(PairFacts { mean, standard, steps, count })
    }
}

/// What two thermometers differ by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PairFacts {
    /// Mean of the difference, K.
    mean: f64,
    /// Its standard uncertainty by the scatter of the parts, K; `None` where there are too few differences.
    standard: Option<f64>,
    /// Step of the readings of each, K; 0 for one that never changed.
    steps: [f64; 2],
    /// Pairs of readings.
    count: u64,
}

/// The pairs of a procedure inside the evaluated window.
pub(super) struct PairSink(Vec<Track>);

impl PairSink {
    /// Prepares for the channels of a recording.
    pub fn new(procedure: &Procedure, channels: &[Channel]) -> PairSink {
        let slot = |id: &str| channels.iter().position(|c| c.id == id);
        let track = |pair: &ThermometerPair| Track::new(slot(&pair.channel).zip(slot(&pair.reference)));
        PairSink(procedure.thermometer_pairs.iter().map(track).collect())
    }

    /// What was found, pair by pair.
    pub fn finish(self) -> Vec<Option<PairFacts>> {
        self.0.iter().map(Track::facts).collect()
    }
}

impl Sink for PairSink {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for track in &mut self.0 {
            let Some((own, other)) = track.slots else { continue };
            let (Some(own), Some(other)) = (block.values.get(own), block.values.get(other)) else { continue };
            for (a, b) in own.iter().zip(other.iter()) {
                track.push([*a, *b]);
            }
        }
    }
}

/// The rows of every pair that a procedure compares.
pub(super) fn rows(
    procedure: &Procedure,
    found: &[Option<PairFacts>],
    limits: &EffectiveLimits,
) -> Vec<MeasurandRecord> {
    let pairs = procedure.thermometer_pairs.iter().zip(found);
    pairs.map(|(pair, facts)| own_row(&estimate(pair, *facts), &pair.id, &pair.unit, limits)).collect()
}

/// The difference with its uncertainty: scatter of the parts, calibrations and places of the sensors, and steps of the readings.
fn estimate(pair: &ThermometerPair, facts: Option<PairFacts>) -> Estimate {
    let told = note!(
        "thermometer_pair.difference",
        channel = pair.channel.as_str(),
        reference = pair.reference.as_str(),
        n = facts.map_or(0, |f| f.count)
    );
    let Some(PairFacts { mean, standard, steps: [own, other], .. }) = facts else {
        return Estimate::not_identifiable("", &pair.channel, None, UNIT, METHOD).note(told);
    };
    // A reading on a lattice is off by up to half a step, evenly.
    let rounding = own.hypot(other) / 12f64.sqrt();
    let components = vec![
        Component::of(InputQuantity::Thermometer, pair.standard_uncertainty_k, UNIT, 1.0),
        Component::of(InputQuantity::Rounding, rounding, UNIT, 1.0),
    ];
    let spread = match standard {
        Some(standard_uncertainty) => Spread::StudentT { standard_uncertainty, dof: (PARTS - 1) as f64 }
            .with_component(mean, pair.standard_uncertainty_k)
            .with_component(mean, rounding),
        None => Spread::Unknown,
    };
    let measured = Estimate::measured("", &pair.channel, mean, UNIT, spread, METHOD);
    Estimate { components, ..measured }.note(told)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Unit;

    fn track(differences: impl Iterator<Item = f64>) -> Option<PairFacts> {
        let mut track = Track::new(None);
        differences.for_each(|d| track.push([20.0 + d, 20.0]));
        track.facts()
    }

    #[test]
    fn the_mean_holds_every_difference_and_the_parts_tell_its_scatter() {
        let facts = track((0..20_000).map(|i| 0.2 + if i % 2 == 0 { 0.01 } else { -0.01 })).unwrap();
        assert!((facts.mean - 0.2).abs() < 1e-9 && facts.count == 20_000);
        assert!(facts.standard.unwrap() < 1e-9 && (facts.steps[0] - 0.02).abs() < 1e-9, "{facts:?}");
        // A step of 0.1 K in the middle: four parts at either side, 0.05·√(8/7)/√8 by hand.
        let moved = track((0..16_384).map(|i| if i < 8192 { 0.0 } else { 0.1 })).unwrap();
        assert!((moved.standard.unwrap() - 0.05 / 7f64.sqrt()).abs() < 1e-9, "{moved:?}");
    }

    #[test]
    fn too_few_readings_leave_the_uncertainty_open() {
        assert_eq!(track(std::iter::empty()), None);
        assert_eq!(track([0.1; 7].into_iter()).unwrap().standard, None);
    }

    #[test]
    fn calibration_and_steps_stand_in_the_budget() {
        let pair = ThermometerPair {
            id: "d".into(),
            channel: "a".into(),
            reference: "b".into(),
            standard_uncertainty_k: 0.03,
            unit: Unit::parse(UNIT).unwrap(),
        };
        let facts = PairFacts { mean: 0.1, standard: Some(0.0), steps: [0.1, 0.0], count: 100 };
        let found = estimate(&pair, Some(facts));
        let interval = found.interval95().unwrap();
        let standard = 0.03f64.hypot(0.1 / 12f64.sqrt());
        assert!((0.5 * (interval.high - interval.low) - 1.959_964 * standard).abs() < 1e-6, "{interval:?}");
        assert!((found.common() - 0.03).abs() < 1e-12);
    }
}
