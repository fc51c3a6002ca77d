//! The table of a procedure that asks for the noise in bands of frequency.

use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::i18n::note;
use crate::measurand::{Measurand, NOISE_DENSITY_RATIO, RATE_NOISE_DENSITY, SPECTRAL_MASK, Test};
use crate::noise::in_band::{Band, MaskPoint, NoiseTest};

/// A test of the output noise by frequency. This table makes its measurands available: `output_noise_rms`,
/// `rate_noise_density` and `spectral_mask`; beside a test of an influence, the bands of `noise_density_ratio`. Densities are
/// one-sided: white noise of N gives 60·√2·N.
#[derive(Table)]
#[table("noise_test")]
pub(crate) struct NoiseKeys {
    /// Bands in which `rate_noise_density` and `noise_density_ratio` are determined. With several, rows are named `rate@1-10Hz`.
    #[key(name = "band")]
    bands: Vec<BandKeys>,
    /// Corners of the mask of `spectral_mask`, in the order of frequency, joined by straight lines in the logarithms.
    #[key(name = "mask")]
    mask: Vec<MaskKeys>,
}

/// A band of frequencies.
#[derive(Table)]
#[table("noise_test.band")]
pub(crate) struct BandKeys {
    /// Lowest frequency.
    #[key(quantity = "Hz", above = 0, example = "1 Hz")]
    from_hz: f64,
    /// Highest frequency, at most half the sample rate.
    #[key(quantity = "Hz", above = 0, example = "10 Hz")]
    to_hz: f64,
}

/// A corner of the mask.
#[derive(Table)]
#[table("noise_test.mask")]
pub(crate) struct MaskKeys {
    /// Frequency.
    #[key(quantity = "Hz", above = 0, example = "1 Hz")]
    frequency_hz: f64,
    /// Largest one-sided noise density there.
    #[key(quantity = "deg/h/sqrt(Hz)", above = 0, example = "0.5 deg/h/sqrt(Hz)")]
    density: f64,
}

impl From<NoiseKeys> for NoiseTest {
    fn from(keys: NoiseKeys) -> NoiseTest {
        let band = |b: BandKeys| Band { from_hz: b.from_hz, to_hz: b.to_hz };
        let corner = |m: MaskKeys| MaskPoint { frequency_hz: m.frequency_hz, density: m.density };
        NoiseTest {
            bands: keys.bands.into_iter().map(band).collect(),
            mask: keys.mask.into_iter().map(corner).collect(),
        }
    }
}

/// What a test of the noise and its measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    for section in root.tables("measurand") {
        let in_bands = |m: &&'static Measurand| m.test() == Test::NoiseInBands || **m == NOISE_DENSITY_RATIO;
        let Some(measurand) = section.measurand("id").filter(in_bands) else { continue };
        let missing = match &procedure.noise_test {
            None => "noise_test",
            Some(test)
                if test.bands.is_empty()
                    && (*measurand == RATE_NOISE_DENSITY || *measurand == NOISE_DENSITY_RATIO) =>
            {
                "[noise_test.band]"
            }
            Some(test) if *measurand == SPECTRAL_MASK && test.mask.len() < 2 => "[noise_test.mask]",
            Some(_) => continue,
        };
        let message = note!("check_temperature.needs_table", id = measurand.id, table = missing);
        reader.error(&section.span_of("id"), message, None);
    }
    let Some(section) = root.table("noise_test") else { return };
    let highest_hz = procedure.sample_rate_hz.map_or(f64::INFINITY, |rate| 0.5 * rate);
    for band in section.tables("band") {
        let (Some(from), Some(to)) = (band.number("from"), band.number("to")) else { continue };
        if to <= from {
            reader.error(&band.span_of("to"), "noise_check.band_order", None);
        } else if to > highest_hz {
            let message = note!("noise_check.beyond", highest_hz);
            reader.error(&band.span_of("to"), message, None);
        }
    }
    let mut before = 0.0;
    for corner in section.tables("mask") {
        let Some(frequency) = corner.number("frequency") else { continue };
        if frequency <= before {
            reader.error(&corner.span_of("frequency"), "noise_check.mask_order", None);
        } else if frequency > highest_hz {
            let message = note!("noise_check.beyond", highest_hz);
            reader.error(&corner.span_of("frequency"), message, None);
        }
        before = frequency;
    }
}
