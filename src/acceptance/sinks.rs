//! What every kind of test collects while the recording goes by: channels that must stay within a band, the envelope of
//! what is drawn over time, samples at declared rails.

use super::condition::stability_track::{Band, StabilityFacts, StabilityKey, StabilityTrack};
use super::condition::status_track::StatusTrack;
use crate::config::procedure::Procedure;
use crate::i18n::note;
use crate::noise::envelope::{Envelope, EnvelopeAccumulator};
use crate::recording::integrity::Fault;
use crate::recording::{Channel, Role, SampleBlock, Sink};
use std::collections::BTreeMap;

/// The channels that must stay within a band, and the status words, inside the evaluated window.
pub(super) struct StabilitySink {
    /// Condition, position among the channels, statistics.
    tracks: Vec<(StabilityKey, usize, StabilityTrack)>,
    /// Position among the channels where there is one, and what the words say.
    statuses: Vec<(Option<usize>, StatusTrack)>,
    start_s: f64,
    interval_s: f64,
}

impl StabilitySink {
    /// Prepares for the conditions of a procedure. `start_s` is the stamp of the first row.
    pub fn new(procedure: &Procedure, channels: &[Channel], tau0_s: f64, start_s: f64) -> StabilitySink {
        let conditions = &procedure.conditions;
        let temperatures = conditions.temperatures.iter().enumerate().map(|(i, c)| {
            let band = Band::about(c.nominal_deg_c, c.tolerance_deg_c);
            (StabilityKey::temperature(i), &c.channel, StabilityTrack::new(c.smoothing_s, tau0_s, Some(band)))
        });
        let supplies = conditions.supplies.iter().enumerate().map(|(i, c)| {
            let band = Band::about(c.nominal_v, c.tolerance_v);
            (StabilityKey::supply(i), &c.channel, StabilityTrack::new(0.0, tau0_s, Some(band)))
        });
        let ranges = conditions.ranges.iter().enumerate().filter_map(|(i, c)| {
            let bounds = c.bounds(channels.iter().find(|channel| channel.id == c.channel)?).ok()?;
            let band = Band { low: bounds.low, high: bounds.high };
            let track = StabilityTrack::new(c.smoothing_s, tau0_s, Some(band));
            Some((StabilityKey::range(i), &c.channel, track))
        });
        let slot_of = |id: &str| channels.iter().position(|c| c.id == id);
        let tracks = temperatures
            .chain(supplies)
            .chain(ranges)
            .filter_map(|(key, channel, track)| Some((key, slot_of(channel)?, track)))
            .collect();
        let statuses =
            conditions.statuses.iter().map(|c| (slot_of(&c.channel), StatusTrack::new(c))).collect();
        StabilitySink { tracks, statuses, start_s, interval_s: tau0_s }
    }

    /// The statistics by condition, and what each status word says.
    pub fn finish(self) -> (BTreeMap<StabilityKey, StabilityFacts>, Vec<StatusTrack>) {
        let held = self.tracks.into_iter().filter_map(|(key, _, track)| Some((key, track.finish()?)));
        (held.collect(), self.statuses.into_iter().map(|(_, track)| track).collect())
    }
}

impl Sink for StabilitySink {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for (_, slot, track) in &mut self.tracks {
            if let Some(values) = block.values.get(*slot) {
                track.push(values, block.time_s - self.start_s, block.continues);
            }
        }
        for (slot, track) in &mut self.statuses {
            if let Some(values) = slot.and_then(|s| block.values.get(s)) {
                track.push(values, block.time_s - self.start_s, self.interval_s);
            }
        }
    }
}

/// The whole recording for the plot over time, what is left out of the evaluation included; and the samples at the
/// rails that the procedure declares.
pub(super) struct Overview {
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
                    // The inside value is the rate; an angle has no rails.
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
                let note = note!("fault_note.declared_rails", count = r.count);
                Some(Fault {
                    kind: "saturated".into(),
                    channel: Some(r.channel.clone()),
                    time_s: Some(time_s),
                    file: None,
                    row,
                    count: r.count,
                    seen: note,
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
