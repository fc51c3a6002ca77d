//! The step of a rounded output that its values would have shown.

use super::solve;
use super::spectrum::Expected;
use crate::effect::Effect;
use crate::mismatch::noticeable_record::{Basis, NoticeableSize};
use crate::mismatch::problem::Problem;
use crate::mismatch::quantization_grid::QuantizationGrid;
use crate::mismatch::terms::SpectralTerm;

/// Twice the expected gain in the spectrum with which a rounding gains anything in 95 of 100 records: (2 · 1.645)².
const DETECTABLE_GAIN: f64 = 10.82;
/// Largest step that is considered, arcsec.
const MAX_STEP_ARCSEC: f64 = 1e9;

/// In a record whose values lie on no grid, a rounding coarse enough to be one beside the noise of a sample is found by
/// the grid, as long as the spectrum does not speak against it. `None` for values that lie on one.
pub(super) fn size(
    effect: &'static dyn Effect,
    problem: &Problem,
    expected: &Expected<'_>,
    by_spectrum: &NoticeableSize,
) -> Option<NoticeableSize> {
    if problem.quantization_grid.is_some() || problem.claim.quantization_lsb_arcsec > 0.0 {
        return None;
    }
    let noise_arcsec = 60.0 * expected.best.hypothesis.noise.base[0] * problem.grid.dt_s.sqrt();
    let finest = QuantizationGrid::finest_arcsec(noise_arcsec);
    let gain = |step: f64| expected.gain_with(SpectralTerm { effect, fitted: vec![step], stated: false });
    let size = solve::size(finest.max(1e-9), MAX_STEP_ARCSEC, DETECTABLE_GAIN, gain)?.max(finest);
    (size < by_spectrum.size).then(|| NoticeableSize { size, basis: Basis::Values, ..by_spectrum.clone() })
}
