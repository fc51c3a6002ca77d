//! Markov noise and quasi-periodic disturbances of the joint fit: the strongest of each, the others in a note.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::Estimate;
use crate::message::{Arg, Note};

pub(super) struct CorrelatedNoise;

const IDS: [(&str, &str); 5] = [
    ("markov_sigma", "deg/h"),
    ("markov_correlation_time", "s"),
    ("quasi_periodic_amplitude", "deg/h"),
    ("quasi_periodic_frequency", "Hz"),
    ("quasi_periodic_coherence_time", "s"),
];

impl Measurand for CorrelatedNoise {
    fn ids(&self) -> &'static [&'static str] {
        &[
            "markov_sigma",
            "markov_correlation_time",
            "quasi_periodic_amplitude",
            "quasi_periodic_frequency",
            "quasi_periodic_coherence_time",
        ]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        let (id, unit) = *IDS.iter().find(|(known, _)| *known == id)?;
        let found = &gyro.identification;
        // Each process: the quantity asked for, its size, and a place that names it among others.
        let processes: Vec<(&Estimate, f64, Note)> = if id.starts_with("markov") {
            found
                .markov
                .iter()
                .map(|m| {
                    let asked = if id == "markov_sigma" { &m.sigma } else { &m.correlation_time };
                    let size = m.sigma.value.unwrap_or(0.0);
                    let place = Note::new("correlated.markov")
                        .with("sigma", size)
                        .with("time_s", m.correlation_time.value.unwrap_or(f64::NAN));
                    (asked, size, place)
                })
                .collect()
        } else {
            found
                .quasi_periodic
                .iter()
                .map(|q| {
                    let asked = match id {
                        "quasi_periodic_amplitude" => &q.amplitude,
                        "quasi_periodic_frequency" => &q.frequency,
                        _ => &q.coherence_time,
                    };
                    let size = q.amplitude.value.unwrap_or(0.0);
                    let place = Note::new("correlated.quasi_periodic")
                        .with("rms", size)
                        .with("frequency_hz", q.frequency.value.unwrap_or(f64::NAN));
                    (asked, size, place)
                })
                .collect()
        };
        let strongest = (0..processes.len()).max_by(|a, b| processes[*a].1.total_cmp(&processes[*b].1));
        let Some(strongest) = strongest else {
            let none = Estimate::not_identifiable(id, &gyro.channel, None, unit, found.method);
            let key =
                if id.starts_with("markov") { "correlated.no_markov" } else { "correlated.no_periodic" };
            return Some(none.note(Note::new(key)));
        };
        let mut estimate = processes[strongest].0.clone();
        (estimate.id, estimate.unit) = (id, unit);
        estimate.channel.clone_from(&gyro.channel);
        let others: Vec<Arg> = processes
            .into_iter()
            .enumerate()
            .filter(|(i, _)| *i != strongest)
            .map(|(_, (_, _, place))| Arg::from(place))
            .collect();
        if others.is_empty() {
            return Some(estimate);
        }
        Some(estimate.note(Note::new("correlated.others").with("others", Arg::Several(others, "; ".into()))))
    }
}
