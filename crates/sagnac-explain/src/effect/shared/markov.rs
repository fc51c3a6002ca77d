//! Exponentially correlated noise (first-order Gauss-Markov process), short and long.

use crate::effect::{ModeBin, SpectralContext};
use crate::noise::composite::{Damped, Sampling};

/// Correlation time, in samples, that divides short from long.
pub(in crate::effect) const SHORT_SAMPLES: f64 = 10.0;

/// The process of fitted parameters (correlation time s, standard deviation deg/h).
pub(in crate::effect) fn process(fitted: &[f64]) -> Damped {
    let (time, sigma) = (fitted.first().copied().unwrap_or(1.0), fitted.get(1).copied().unwrap_or(0.0));
    Damped { rms_deg_h: sigma, frequency_hz: 0.0, decay_time_s: time }
}

/// Densities of a Markov process or an oscillation: exact in single modes, which a record shorter than some correlation
/// times needs.
pub(in crate::effect) fn densities(process: &Damped, bins: &[ModeBin]) -> Vec<f64> {
    let Some(first) = bins.first() else { return vec![] };
    let modes = process.modes(first.samples, first.dt_s, Sampling::Averaging);
    let far = process.densities(first.dt_s, Sampling::Averaging);
    // Far above 1/(record length) the modes hold what the density says.
    let exact = |b: &ModeBin| b.modes == 1 && b.mode < 64;
    bins.iter().map(|b| if exact(b) { modes.power(b.mode) } else { far.at(b.frequency_hz) }).collect()
}

/// Starts over correlation times from `low` to `high`, each with the level that the excess at its corner asks for.
pub(in crate::effect) fn starts_between(low: f64, high: f64, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
    let mut out = vec![];
    let mut time = low;
    while time <= high {
        let corner = 1.0 / (2.0 * std::f64::consts::PI * time);
        let below = context
            .bins
            .iter()
            .enumerate()
            .filter(|(_, b)| b.frequency_hz > corner / 4.0 && b.frequency_hz < corner * 2.0);
        let (mut excess, mut count, mut level) = (0.0, 0.0, 0.0);
        for (i, b) in below {
            excess += b.modes as f64 * (context.observed[i] - context.expected[i]);
            level += b.modes as f64 * context.expected[i];
            count += b.modes as f64;
        }
        if count > 0.0 {
            let density = (excess / count).max(0.1 * level / count);
            // Of a plateau 2σ²T about a half is left around the corner.
            out.push(vec![time, (density / time).sqrt()]);
        }
        time *= 4.0;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bins(n: usize, dt_s: f64) -> Vec<ModeBin> {
        let bin = |mode: usize| ModeBin {
            frequency_hz: mode as f64 / (2.0 * n as f64 * dt_s),
            mode,
            modes: 1,
            samples: n,
            dt_s,
            even_ends: false,
        };
        (1..n).map(bin).collect()
    }

    #[test]
    fn far_below_the_corner_the_density_is_twice_the_variance_times_the_time() {
        let process = process(&[0.8, 3.0]);
        assert_eq!((process.decay_time_s, process.rms_deg_h, process.frequency_hz), (0.8, 3.0, 0.0));
        // 2σ²T = 14.4 (deg/h)²/Hz, less a part in 10⁴ at a hundredth of the corner of 0.2 Hz.
        let at = densities(&process, &bins(40_000, 0.01)[..2]);
        assert!(at.iter().all(|s| (s / 14.4 - 1.0).abs() < 0.01), "{at:?}");
    }

    #[test]
    fn starts_cover_the_times_in_steps_of_four_with_the_level_of_the_excess() {
        let bins = bins(4096, 1.0);
        let expected = vec![2.0; bins.len()];
        let observed = vec![6.0; bins.len()];
        let context =
            SpectralContext { bins: &bins, observed: &observed, expected: &expected, grid_step_arcsec: None };
        let starts = starts_between(10.0, 200.0, &context);
        // An excess of 4 everywhere: σ² T = 4.
        let truth: Vec<Vec<f64>> = [10.0f64, 40.0, 160.0].map(|t| vec![t, (4.0 / t).sqrt()]).into();
        assert_eq!(starts, truth);
        // Where nothing exceeds, a tenth of the level stands in.
        let none =
            SpectralContext { bins: &bins, observed: &expected, expected: &expected, grid_step_arcsec: None };
        assert!((starts_between(10.0, 10.0, &none)[0][1] - 0.02f64.sqrt()).abs() < 1e-12);
        assert!(process(&[]).decay_time_s == 1.0 && densities(&process(&[1.0, 1.0]), &[]).is_empty());
    }
}
