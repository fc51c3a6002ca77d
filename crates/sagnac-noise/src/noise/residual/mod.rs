//! Goodness of fit: the record with the model taken out of it, judged in frequency, lag, averaging time, amplitude, and by
//! jumps of its level.
//!
//! Every view gives a probability that counts the search within the view and what fitted parameters took, and says
//! where and by how much the record departs most. Measured on simulated records (`tests/it/goodness_of_fit.rs`).

mod amplitude;
mod averaging;
mod frequency;
mod grid;
mod jump;
mod lag;
mod null;
mod spectrum;
mod view;
mod whiten;

pub use amplitude::{Amplitude, TAIL_DEVIATIONS};
pub use averaging::{OctaveRatio, degrees_of_freedom};
pub use frequency::BandRatio;
pub use jump::Jump;
pub use lag::ResidualCorrelation;
pub use view::{Departure, Judged, View};
pub use whiten::{JumpInstead, Whitened, whitened};

use super::composite::{Described, Line};
use super::data::DeviationPoint;
use super::spectral_record::SpectralRecord;
use crate::numeric::order::SortByNumber;

/// Probability, for all views together, below which a departure is called one.
pub const FAMILYWISE_LEVEL: f64 = 0.01;

/// How well a description fits a record.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GoodnessOfFit {
    /// The views that the record is long enough for.
    pub views: Vec<Judged>,
    /// Power over model by frequency.
    pub bands: Vec<BandRatio>,
    /// Allan variance over model by octave.
    pub octaves: Vec<OctaveRatio>,
    /// Autocorrelation of the whitened block means.
    pub correlation: Option<ResidualCorrelation>,
    /// Autocorrelation of whitened single samples, where blocks hold several.
    pub sample_correlation: Option<ResidualCorrelation>,
    /// Distribution of the whitened block means.
    pub amplitude: Option<Amplitude>,
    /// The whitened block means.
    pub whitened: Option<Whitened>,
}

/// What the statistics of a record give.
struct OfRecord {
    bands: frequency::Bands,
    sample_correlation: Option<ResidualCorrelation>,
    averaging: (Vec<OctaveRatio>, Option<Judged>),
}

/// What its whitened block means give.
struct OfResiduals {
    whitened: Option<Whitened>,
    correlation: Option<ResidualCorrelation>,
    amplitude: Option<Amplitude>,
    jump: Option<Judged>,
}

impl GoodnessOfFit {
    /// Judges a description of a record. `octaves`: its overlapping Allan deviations.
    pub fn of(
        record: &SpectralRecord<'_>,
        described: &Described,
        octaves: &[DeviationPoint],
    ) -> GoodnessOfFit {
        let tau0_s = record.tau0_s;
        let evidence = record.evidence(record.lines);
        if described.model.parts().is_empty() || !(evidence.usable_s > 0.0 && tau0_s > 0.0) {
            return GoodnessOfFit::default();
        }
        let mut described = described.clone();
        if described.model.lines.is_empty() {
            // Lines are left out of the fit and are in the Allan deviation all the same.
            described.model.lines = record
                .lines
                .iter()
                .map(|l| Line { amplitude_deg_h: l.amplitude_deg_h, frequency_hz: l.frequency_hz })
                .collect();
        }
        let grid = grid::Grid::new(&described, evidence.usable_s, tau0_s);
        let of_record = || OfRecord {
            bands: frequency::Bands::new(&evidence, &described, tau0_s),
            sample_correlation: lag::of_samples(record, &described, &grid),
            averaging: averaging::judge(octaves, &described, &grid, tau0_s),
        };
        let of_residuals = || {
            let whitened = whitened(record, &described.model);
            OfResiduals {
                correlation: whitened.as_ref().and_then(|w| lag::of_blocks(w, &grid)),
                amplitude: whitened.as_ref().and_then(amplitude::of),
                jump: whitened.as_ref().and_then(|w| Some(jump::judge(w.jump.as_ref()?, w.step_s, w.from_s))),
                whitened,
            }
        };
        // One looks at the statistics of the record and the other at residuals: neither waits for the other.
        let (OfRecord { bands, sample_correlation, averaging }, residuals) =
            rayon::join(of_record, of_residuals);
        let OfResiduals { whitened, correlation, amplitude, jump } = residuals;
        let (octaves, averaging) = averaging;
        let looks: Vec<&ResidualCorrelation> = sample_correlation.iter().chain(&correlation).collect();
        let amplitudes = amplitude.as_ref().map(amplitude::judge);
        let views = [bands.judge(), lag::judge(&looks), averaging, amplitudes, jump];
        GoodnessOfFit {
            views: views.into_iter().flatten().collect(),
            bands: bands.bands,
            octaves,
            correlation,
            sample_correlation,
            amplitude,
            whitened,
        }
    }

    /// The views in which the model fails: Holm's procedure over all views at [`FAMILYWISE_LEVEL`].
    pub fn failures(&self) -> Vec<&Judged> {
        let mut sorted: Vec<&Judged> = self.views.iter().collect();
        sorted.sort_ascending_by(|a| a.p_value);
        let count = sorted.len();
        let passed =
            (0..count).find(|i| sorted[*i].p_value * (count - i) as f64 > FAMILYWISE_LEVEL).unwrap_or(count);
        sorted.truncate(passed);
        sorted.sort_by_key(|j| j.view);
        sorted
    }
}
