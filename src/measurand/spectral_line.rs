//! The strongest spectral line.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread};
use crate::text::Note;

pub(super) struct SpectralLine;

impl Measurand for SpectralLine {
    fn ids(&self) -> &'static [&'static str] {
        &["line_frequency", "line_amplitude"]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        let frequency = id == "line_frequency";
        let (id, unit) = if frequency { ("line_frequency", "Hz") } else { ("line_amplitude", "deg/h") };
        let strongest = gyro.lines.iter().max_by(|a, b| a.amplitude_deg_h.total_cmp(&b.amplitude_deg_h));
        let Some(line) = strongest else {
            let none = Estimate::not_identifiable(id, &gyro.channel, None, unit, "welch");
            return Some(none.note(Note::new("note.no_line")));
        };
        let (value, standard_uncertainty) = if frequency {
            (line.frequency_hz, line.frequency_uncertainty_hz)
        } else {
            (line.amplitude_deg_h, line.amplitude_uncertainty_deg_h)
        };
        Some(Estimate::measured(id, &gyro.channel, value, unit, Spread::Normal { standard_uncertainty }, "welch"))
    }
}
