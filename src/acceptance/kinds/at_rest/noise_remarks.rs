//! What the description of the noise holds beside N, B, K, R and Q, what it rests on and what it leaves out.

use crate::estimate::Estimate;
use crate::i18n::{Arg, Note, note};
use crate::measurand::GyroEvidence;
use crate::noise::composite::Bandwidth;
use crate::noise::identification::{MarkovFound, QuasiPeriodicFound};

/// Share of a stretch below which the residual is said to hold only a part of the record.
const WHOLE_SHARE: f64 = 0.999;

/// A number with the 95 % interval of its estimate, where there is one.
fn with_interval(value: f64, estimate: Option<&Estimate>) -> Arg {
    let figures = |v: f64| Arg::Figures { value: v, digits: 3, zeros: false };
    match estimate.and_then(Estimate::interval95) {
        Some(i) => Arg::from(note!(
            "described_interval.value",
            value = figures(value),
            low = figures(i.low),
            high = figures(i.high)
        )),
        None => figures(value),
    }
}

/// Whether an estimate speaks of a process of the description, which was polished once more.
fn same(estimate: Option<f64>, described: f64) -> bool {
    estimate.is_some_and(|v| (v - described).abs() < 5e-3 * described.abs())
}

/// The sentences of a channel.
pub fn remarks(gyro: &GyroEvidence) -> Vec<Note> {
    let found = &gyro.identification;
    let model = &found.described.model;
    if model.parts().is_empty() {
        return vec![];
    }
    let number = |v: f64| Arg::Figures { value: v, digits: 3, zeros: false };
    let mut notes = vec![];
    for d in &model.markov {
        let size = |m: &&MarkovFound| same(m.sigma.value, d.rms_deg_h);
        let estimates = found.markov.iter().find(size);
        notes.push(note!(
            "described.markov",
            sigma = with_interval(d.rms_deg_h, estimates.map(|m| &m.sigma)),
            time_s = with_interval(d.decay_time_s, estimates.map(|m| &m.correlation_time))
        ));
    }
    for d in &model.quasi_periodic {
        let size = |q: &&QuasiPeriodicFound| same(q.amplitude.value, d.rms_deg_h);
        let estimates = found.quasi_periodic.iter().find(size);
        notes.push(note!(
            "described.quasi_periodic",
            rms = with_interval(d.rms_deg_h, estimates.map(|q| &q.amplitude)),
            frequency_hz = with_interval(d.frequency_hz, estimates.map(|q| &q.frequency)),
            time_s = with_interval(d.decay_time_s, estimates.map(|q| &q.coherence_time))
        ));
    }
    let cutoff = found.cutoff.as_ref().and_then(|c| c.value);
    match (&model.bandwidth, cutoff) {
        (Some(Bandwidth::MovingAverage { samples }), Some(_)) => {
            notes.push(note!("described.moving_average", n = u64::from(*samples)));
        }
        (Some(Bandwidth::FirstOrder { .. }), Some(hz)) => {
            notes.push(note!("described.cutoff", hz = with_interval(hz, found.cutoff.as_ref())));
        }
        (None, Some(hz)) => {
            notes.push(note!("described.cutoff", hz = with_interval(hz, found.cutoff.as_ref())));
        }
        // A filter that acts beyond the range of the fit is not stated.
        (_, None) => {}
    }
    let nyquist_hz = 0.5 / gyro.tau0_s;
    let highest_hz = found
        .estimates()
        .into_iter()
        .flat_map(|e| &e.notes)
        .filter(|n| n.id == "note.fit_restricted")
        .find_map(|n| match n.args.get("highest_hz") {
            Some(Arg::Number(hz)) => Some(*hz),
            _ => None,
        });
    let range = |key: &'static str| {
        Note::new(key)
            .with("from_hz", number(0.5 / gyro.usable_s()))
            .with("to_hz", number(highest_hz.unwrap_or(nyquist_hz)))
    };
    notes.push(match gyro.lines.len() {
        0 => range("described.range"),
        n => range("described.range_without_lines").with("n", n),
    });
    notes.push(note!("described.leaves_out"));
    if let Some(whitened) = gyro.goodness.whitened.as_ref().filter(|w| w.share < WHOLE_SHARE) {
        let percent = Arg::Figures { value: 100.0 * whitened.share, digits: 3, zeros: false };
        notes.push(note!("described.longest_stretch", percent));
    }
    notes
}
