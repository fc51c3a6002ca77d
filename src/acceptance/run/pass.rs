//! The sinks of a static test: everything is collected while the recording goes by once.

use crate::acceptance::condition::stability_track::{Band, StabilityFacts, StabilityKey, StabilityTrack};
use crate::config::procedure::Procedure;
use crate::i18n::Note;
use crate::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use crate::noise::envelope::{Envelope, EnvelopeAccumulator};
use crate::noise::family::Estimator;
use crate::noise::tau_grid::TauGrid;
use crate::recording::integrity::Fault;
use crate::recording::{Channel, Role, SampleBlock, Sink};
use crate::temperature::track::{Means, Track};
use std::collections::BTreeMap;

/// What is collected inside the evaluated window.
pub struct Inside {
    /// Position among the channels, and digest.
    gyros: Vec<(usize, RateAccumulator)>,
    stability: Vec<(StabilityKey, usize, StabilityTrack)>,
    /// Block means of gyros and temperatures for tests over temperature and of the warm-up, with their positions among
    /// the channels.
    track: Option<(Vec<usize>, Track)>,
    start_s: f64,
}

/// What the window left behind.
pub struct Collected {
    /// Per gyro channel: position among the channels, digest.
    pub gyros: Vec<(usize, RateDigest)>,
    /// Channels that must stay within a band.
    pub stability: BTreeMap<StabilityKey, StabilityFacts>,
    /// Block means, and the channels that they are of.
    pub means: Option<(Vec<usize>, Means)>,
}

impl Inside {
    /// Prepares for the channels of a procedure.
    pub fn new(
        procedure: &Procedure,
        channels: &[Channel],
        grid: &TauGrid,
        estimators: &[Estimator],
        exact: bool,
        tau0_s: f64,
        start_s: f64,
    ) -> Inside {
        let gyros = channels
            .iter()
            .enumerate()
            .filter(|(_, c)| c.role.is_gyro())
            .map(|(slot, _)| {
                let plan = DigestPlan {
                    taus: grid.clone(),
                    exact,
                    estimators: estimators.to_vec(),
                    ..DigestPlan::new(tau0_s)
                };
                (slot, RateAccumulator::new(plan))
            })
            .collect();
        let slot_of = |id: &str| channels.iter().position(|c| c.id == id);
        let mut stability = Vec::new();
        for (i, c) in procedure.conditions.temperatures.iter().enumerate() {
            if let Some(slot) = slot_of(&c.channel) {
                let band = Band::about(c.nominal_deg_c, c.tolerance_deg_c);
                let track = StabilityTrack::new(c.smoothing_s, tau0_s, Some(band));
                stability.push((StabilityKey::temperature(i), slot, track));
            }
        }
        for (i, c) in procedure.conditions.supplies.iter().enumerate() {
            if let Some(slot) = slot_of(&c.channel) {
                let band = Band::about(c.nominal_v, c.tolerance_v);
                let track = StabilityTrack::new(0.0, tau0_s, Some(band));
                stability.push((StabilityKey::supply(i), slot, track));
            }
        }
        let tracked = |c: &Channel| c.role.is_gyro() || matches!(c.role, Role::Temperature | Role::Supply);
        let asked = procedure.temperature_test.is_some() || procedure.warm_up_test.is_some();
        let track = asked.then(|| {
            let slots: Vec<usize> =
                channels.iter().enumerate().filter(|(_, c)| tracked(c)).map(|(slot, _)| slot).collect();
            let track = Track::new(slots.len(), tau0_s);
            (slots, track)
        });
        Inside { gyros, stability, track, start_s }
    }

    /// The same without the gyro channels: only what must stay within a band.
    pub fn stability_only(mut self) -> Inside {
        self.gyros.clear();
        self
    }

    /// What was collected.
    pub fn finish(self) -> Collected {
        let gyros = self.gyros.into_iter().map(|(slot, digest)| (slot, digest.finish())).collect();
        let stability =
            self.stability.into_iter().filter_map(|(key, _, track)| Some((key, track.finish()?))).collect();
        let means = self.track.and_then(|(slots, track)| Some((slots, track.finish()?)));
        Collected { gyros, stability, means }
    }
}

impl Sink for Inside {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for (slot, digest) in &mut self.gyros {
            if let Some(values) = block.values.get(*slot) {
                digest.push(values, block.first_index, block.continues);
            }
        }
        for (_, slot, track) in &mut self.stability {
            if let Some(values) = block.values.get(*slot) {
                track.push(values, block.time_s - self.start_s, block.continues);
            }
        }
        if let Some((slots, track)) = &mut self.track {
            for (at, slot) in slots.iter().enumerate() {
                if let Some(values) = block.values.get(*slot) {
                    track.push(at, values, block.first_index);
                }
            }
        }
    }
}

/// The whole recording for the plot over time, what is left out of the evaluation included; and the samples at the
/// rails that the procedure declares.
pub struct Overview {
    channels: Vec<(usize, EnvelopeAccumulator)>,
    rails: Vec<Rails>,
}

/// Declared rails of a channel and the samples at them.
struct Rails {
    slot: usize,
    channel: String,
    low: f64,
    high: f64,
    count: u64,
    first: Option<(u64, f64)>,
}

impl Overview {
    /// Prepares for the channels that are drawn.
    pub fn new(procedure: &Procedure, channels: &[Channel], tau0_s: f64) -> Overview {
        let drawn = |r: Role| r.is_gyro() || matches!(r, Role::Temperature | Role::Supply);
        Overview {
            channels: channels
                .iter()
                .enumerate()
                .filter(|(_, c)| drawn(c.role))
                .map(|(slot, _)| (slot, EnvelopeAccumulator::new()))
                .collect(),
            rails: channels
                .iter()
                .enumerate()
                .filter_map(|(slot, c)| {
                    let spec = procedure.channel(&c.id)?;
                    // What is inside is the rate; an angle has no rails.
                    let angle = c.role == Role::AccumulatedAngle;
                    if angle || spec.rail_low.is_none() && spec.rail_high.is_none() {
                        return None;
                    }
                    // Rails of increments are stated as angles; inside, increments are rates.
                    let factor = if c.role == Role::AngleIncrement { 1.0 / tau0_s } else { 1.0 };
                    let low = spec.rail_low.map_or(f64::NEG_INFINITY, |v| v * factor);
                    let high = spec.rail_high.map_or(f64::INFINITY, |v| v * factor);
                    Some(Rails { slot, channel: c.id.clone(), low, high, count: 0, first: None })
                })
                .collect(),
        }
    }

    /// Samples at declared rails: one fault a channel.
    pub fn saturated(&self) -> Vec<Fault> {
        self.rails
            .iter()
            .filter_map(|r| {
                let (row, time_s) = r.first?;
                let note = Note::new("fault_note.declared_rails").with("count", r.count);
                Some(Fault {
                    kind: "saturated".into(),
                    channel: Some(r.channel.clone()),
                    time_s: Some(time_s),
                    file: None,
                    row,
                    count: r.count,
                    message: note,
                })
            })
            .collect()
    }

    /// The envelopes by position of the channel.
    pub fn finish(&self) -> BTreeMap<usize, Envelope> {
        self.channels.iter().map(|(slot, e)| (*slot, e.finish())).collect()
    }
}

impl Sink for Overview {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for (slot, envelope) in &mut self.channels {
            if let Some(values) = block.values.get(*slot) {
                envelope.push(values, block.first_index);
            }
        }
        for r in &mut self.rails {
            let Some(values) = block.values.get(r.slot) else { continue };
            for (i, v) in values.iter().enumerate() {
                if *v <= r.low || *v >= r.high {
                    r.count += 1;
                    r.first.get_or_insert((block.first_row + i as u64, block.time_s));
                }
            }
        }
    }
}
