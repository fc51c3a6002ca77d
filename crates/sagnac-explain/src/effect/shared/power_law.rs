//! Frequencies at which a power-law term of the noise shows.

use crate::effect::{Domain, Place, SpectralContext};
use crate::noise::data::NoiseType;
use crate::noise::model::unit_density;

/// Frequencies at which a power-law term is the largest part of the observed spectrum, or, where it
/// nowhere is, those at which it comes nearest to that.
pub(in crate::effect) fn power_law_places(
    term: NoiseType,
    fitted: &[f64],
    context: &SpectralContext<'_>,
) -> Vec<Place> {
    let Some(coefficient) = fitted.first() else { return vec![] };
    let share = |i: usize| {
        let bin = &context.bins[i];
        coefficient * coefficient * unit_density(term, bin.frequency_hz, bin.dt_s)
            / context.observed[i].max(context.expected[i])
    };
    let shares: Vec<f64> = (0..context.bins.len()).map(share).collect();
    let largest = shares.iter().copied().fold(0.0, f64::max);
    let enough = (0.5f64).min(0.5 * largest);
    let among =
        || context.bins.iter().zip(&shares).filter(|(_, s)| **s >= enough).map(|(b, _)| b.frequency_hz);
    let (from, to) = (among().fold(f64::INFINITY, f64::min), among().fold(0.0, f64::max));
    if from <= to { vec![Place { domain: Domain::Frequency, from, to }] } else { vec![] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::ModeBin;

    #[test]
    fn a_term_lives_where_it_is_the_larger_half() {
        let bin = |i: usize| ModeBin {
            frequency_hz: 0.1 * (i + 1) as f64,
            mode: i + 1,
            modes: 1,
            samples: 100,
            dt_s: 1.0,
            even_ends: false,
        };
        let bins: Vec<ModeBin> = (0..4).map(bin).collect();
        // White noise of N = 1/60 deg/√h has 1 (deg/h)²/Hz everywhere.
        let white = [1.0 / 60.0];
        let over = |observed: &[f64]| {
            let context =
                SpectralContext { bins: &bins, observed, expected: &[0.5; 4], grid_step_arcsec: None };
            power_law_places(NoiseType::AngleRandomWalk, &white, &context)
        };
        let [place] = over(&[9.0, 1.5, 1.9, 4.0])[..] else { panic!("one place") };
        assert!((place.from - 0.2).abs() < 1e-12 && (place.to - 0.3).abs() < 1e-12, "{place:?}");
        // Nowhere the larger half: from half of its largest share, 1/4, on.
        let [place] = over(&[9.0, 7.0, 4.0, 9.0])[..] else { panic!("one place") };
        assert!((place.from - 0.2).abs() < 1e-12 && (place.to - 0.3).abs() < 1e-12, "{place:?}");
        let context =
            SpectralContext { bins: &bins, observed: &[1.0; 4], expected: &[1.0; 4], grid_step_arcsec: None };
        assert!(power_law_places(NoiseType::AngleRandomWalk, &[], &context).is_empty());
    }
}
