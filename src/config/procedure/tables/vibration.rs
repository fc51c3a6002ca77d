//! The table of a procedure that asks for the effects of vibration by frequency.

use crate::config::procedure::model::{ChannelSpec, Procedure};
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::i18n::note;
use crate::influence::ByFrequency;
use crate::measurand::{
    Measurand, VIBRATION_RECTIFICATION_IN_BAND, VIBRATION_RESONANCE_FREQUENCY, VIBRATION_RESONANCE_QUALITY,
    VIBRATION_RESONANCE_RESPONSE,
};
use crate::noise::in_band::Band;
use crate::recording::Role;

/// Vibration by frequency, beside [vibration_test]: an accelerometer, recorded at the full rate, tells how much of the vibration lies
/// in which band. This table makes its measurands available: `vibration_rectification_in_band`, `vibration_resonance_frequency`,
/// `vibration_resonance_quality` and `vibration_resonance_response`.
#[derive(Table)]
#[table("vibration_spectrum")]
pub(crate) struct VibrationSpectrumKeys {
    /// Channel of the accelerometer, with the role `acceleration_x` (`_y`, `_z`). Default: the first.
    #[key(id, example = "acc")]
    accelerometer: Option<String>,
    /// Bands, in the order of frequency, of which the bias per mean square of the acceleration is told apart; resonances are
    /// searched in them.
    #[key(name = "band", required)]
    bands: Vec<VibrationBandKeys>,
}

/// A band of frequencies.
#[derive(Table)]
#[table("vibration_spectrum.band")]
pub(crate) struct VibrationBandKeys {
    /// Lowest frequency.
    #[key(quantity = "Hz", above = 0, example = "20 Hz")]
    from_hz: f64,
    /// Highest frequency, at most half the sample rate.
    #[key(quantity = "Hz", above = 0, example = "60 Hz")]
    to_hz: f64,
}

fn is_accelerometer(c: &ChannelSpec) -> bool {
    matches!(c.channel.role, Role::AccelerationX | Role::AccelerationY | Role::AccelerationZ)
}

impl VibrationSpectrumKeys {
    /// What is asked for, with the first accelerometer where none is named.
    pub(crate) fn asked(self, channels: &[ChannelSpec]) -> ByFrequency {
        let first = || channels.iter().find(|c| is_accelerometer(c)).map(|c| c.channel.id.clone());
        ByFrequency {
            accelerometer: self.accelerometer.or_else(first).unwrap_or_default(),
            bands: self.bands.into_iter().map(|b| Band { from_hz: b.from_hz, to_hz: b.to_hz }).collect(),
        }
    }
}

/// Measurands that need the table.
const ITS_OWN: [&Measurand; 4] = [
    &VIBRATION_RECTIFICATION_IN_BAND,
    &VIBRATION_RESONANCE_FREQUENCY,
    &VIBRATION_RESONANCE_QUALITY,
    &VIBRATION_RESONANCE_RESPONSE,
];

/// What the table and its measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let name = VibrationSpectrumKeys::SPEC.name;
    let section = root.table(name);
    for asked in root.tables("measurand") {
        let own = asked.measurand("id").filter(|m| ITS_OWN.contains(m));
        if let (Some(measurand), None) = (own, section) {
            let message = note!("check_temperature.needs_table", id = measurand.id, table = name);
            reader.error(&asked.span_of("id"), message, None);
        }
    }
    let Some(section) = section else { return };
    if root.table("vibration_test").is_none() {
        reader.error(&section.span.clone(), "vibration_check.no_test", None);
    }
    let named = section.text("accelerometer");
    let fits = |c: &ChannelSpec| is_accelerometer(c) && named.as_ref().is_none_or(|id| *id == c.channel.id);
    if !procedure.channels.iter().any(fits) {
        let at = if named.is_some() { section.span_of("accelerometer") } else { section.span.clone() };
        reader.error(&at, "vibration_check.no_accelerometer", None);
    }
    let highest_hz = procedure.sample_rate_hz.map_or(f64::INFINITY, |rate| 0.5 * rate);
    let mut before = 0.0;
    for band in section.tables("band") {
        let (Some(from), Some(to)) = (band.number("from"), band.number("to")) else { continue };
        if to <= from {
            reader.error(&band.span_of("to"), "noise_check.band_order", None);
        } else if to > highest_hz {
            reader.error(&band.span_of("to"), note!("noise_check.beyond", highest_hz), None);
        } else if from < before {
            reader.error(&band.span_of("from"), "vibration_check.bands_overlap", None);
        }
        before = to;
    }
}
