//! What the description of the noise holds beside N, B, K, R and Q, what it rests on and what it leaves out.

use crate::measurand::GyroEvidence;
use crate::noise::composite::Bandwidth;
use crate::text::{Arg, Note};

/// Share of a stretch below which the residual is said to hold only a part of the record.
const WHOLE: f64 = 0.999;

/// The sentences of a channel.
pub(super) fn remarks(gyro: &GyroEvidence) -> Vec<Note> {
    let found = &gyro.identification;
    let model = &found.described.model;
    if model.parts().is_empty() {
        return vec![];
    }
    let number = |v: f64| Arg::Figures { value: v, digits: 3, zeros: false };
    let mut notes = vec![];
    for d in &model.markov {
        notes.push(
            Note::new("described.markov")
                .with("sigma", number(d.rms_deg_h))
                .with("time_s", number(d.decay_time_s)),
        );
    }
    for d in &model.quasi_periodic {
        notes.push(
            Note::new("described.quasi_periodic")
                .with("rms", number(d.rms_deg_h))
                .with("frequency_hz", number(d.frequency_hz))
                .with("time_s", number(d.decay_time_s)),
        );
    }
    let cutoff = found.cutoff.as_ref().and_then(|c| c.value);
    match (&model.bandwidth, cutoff) {
        (Some(Bandwidth::MovingAverage { samples }), _) => {
            notes.push(Note::new("described.moving_average").with("n", u64::from(*samples)));
        }
        (Some(filter), _) => {
            let hz = cutoff.unwrap_or_else(|| filter.cutoff_hz(gyro.tau0_s));
            notes.push(Note::new("described.cutoff").with("hz", number(hz)));
        }
        (None, Some(hz)) => notes.push(Note::new("described.cutoff").with("hz", number(hz))),
        (None, None) => {}
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
    notes.push(Note::new("described.leaves_out"));
    if let Some(whitened) = gyro.goodness.whitened.as_ref().filter(|w| w.share < WHOLE) {
        let percent = Arg::Figures { value: 100.0 * whitened.share, digits: 3, zeros: false };
        notes.push(Note::new("described.longest_stretch").with("percent", percent));
    }
    notes
}
