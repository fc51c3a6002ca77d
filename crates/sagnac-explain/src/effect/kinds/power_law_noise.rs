//! Noise whose density falls with a power of the frequency that is neither of white, flicker nor random walk. It has no
//! kind of its own in the format of explanations.

use crate::effect::{Domain, ModeBin, Param, Place, SpectralContext, Spectrum};
use crate::noise::composite::{Composite, Damped};
use crate::numeric::range::Bounds;

pub struct PowerLawNoise;

static PARAMS: [Param; 3] = [
    Param::reported("density_deg_h_2_per_hz", "(deg/h)²/Hz", 1e-30, 1e30),
    Param::reported("exponent", "", 0.1, 1.9),
    Param::inner("frequency_hz", "Hz", 1e-12, 1e9),
];

describe! {
    PowerLawNoise, "power_law_noise", Spectrum in Frequency, needs [],
    confusers [ExcessFlicker, MarkovShort, MarkovLong, ExcessArw],
    properties [carried_over, outside_format, free_form]
}

/// S₀, α, f₀.
fn law(fitted: &[f64]) -> [f64; 3] {
    match *fitted {
        [density, exponent, at] => [density, exponent, at],
        _ => [0.0, 1.0, 1.0],
    }
}

/// Factor by which means over the sampling interval change the law at `x` cycles a sample, aliases included:
/// sin²(πx)/π² Σ_k x^α |x + k|^(−2−α).
fn averaged(exponent: f64, x: f64) -> f64 {
    if x <= 1e-9 {
        return 1.0;
    }
    let s = 2.0 + exponent;
    let side = |from: f64| {
        let near: f64 = (0..3).map(|k| (from + f64::from(k)).powf(-s)).sum();
        // The rest by Euler and Maclaurin, to 1e-6 of the whole.
        let far = from + 3.0;
        let inverse = 1.0 / far;
        let second = s * inverse / 12.0;
        let fourth = second * (s + 1.0) * (s + 2.0) * inverse * inverse / 60.0;
        let sixth = fourth * (s + 3.0) * (s + 4.0) * inverse * inverse / 42.0;
        near + far.powf(-s) * (far / (s - 1.0) + 0.5 + second - fourth + sixth)
    };
    let sine = (std::f64::consts::PI * x).sin() / std::f64::consts::PI;
    sine * sine * x.powf(exponent) * (side(x) + side(1.0 - x))
}

impl Spectrum for PowerLawNoise {
    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 0).then_some(1.0)
    }

    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        let [density, exponent, at] = law(fitted);
        let one = |bin: &ModeBin| {
            let averaged = averaged(exponent, bin.frequency_hz * bin.dt_s);
            density * (bin.frequency_hz / at).powf(-exponent) * averaged
        };
        bins.iter().map(one).collect()
    }

    fn is_refined(&self, _fitted: &[f64], parameter: usize) -> bool {
        parameter < 2
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        let (Some(first), Some(last)) = (context.bins.first(), context.bins.last()) else { return vec![] };
        let middle = (first.frequency_hz * last.frequency_hz).sqrt();
        let near = |b: &&ModeBin| b.frequency_hz > 0.5 * middle && b.frequency_hz < 2.0 * middle;
        let (mut excess, mut level, mut count) = (0.0, 0.0, 0.0);
        for (i, b) in context.bins.iter().enumerate().filter(|(_, b)| near(b)) {
            excess += b.modes as f64 * (context.observed[i] - context.expected[i]);
            level += b.modes as f64 * context.expected[i];
            count += b.modes as f64;
        }
        let density = (excess / f64::max(count, 1.0)).max(0.05 * level / f64::max(count, 1.0)).max(1e-30);
        [0.4, 0.7, 1.4].map(|exponent| vec![density, exponent, middle]).to_vec()
    }

    fn bounds(&self, _context: &SpectralContext<'_>) -> Vec<Bounds> {
        vec![Bounds::new(1e-30, 1e30), Bounds::new(0.1, 1.9), Bounds::new(1e-12, 1e9)]
    }

    fn trials(&self, _context: &SpectralContext<'_>) -> f64 {
        3.0
    }

    fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
        law(fitted).to_vec()
    }

    /// Relaxations of which each octave of time has one: their sum follows a power law to a few per cent.
    fn compose(&self, fitted: &[f64], dt_s: f64, noise: &mut Composite) {
        use std::f64::consts::{LN_2, PI};
        let [density, exponent, at] = law(fitted);
        // ∫ 2σ²T/(1 + (2πfT)²) dT/T over all T, σ² = c T^(α−1), is c (2πf)^−α π/sin(πα/2).
        let sum = PI / (0.5 * PI * exponent).sin() * (2.0 * PI * at).powf(-exponent);
        let c = density / sum * LN_2;
        for octave in -24..32 {
            let decay_time_s = dt_s * 2f64.powi(octave);
            let rms_deg_h = (c * decay_time_s.powf(exponent - 1.0)).sqrt();
            noise.markov.push(Damped { rms_deg_h, frequency_hz: 0.0, decay_time_s });
        }
    }

    fn places(&self, _fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        match (context.bins.first(), context.bins.last()) {
            (Some(first), Some(last)) => {
                vec![Place { domain: Domain::Frequency, from: first.frequency_hz, to: last.frequency_hz }]
            }
            _ => vec![],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::composite::Sampling;

    #[test]
    fn the_simulated_sum_of_relaxations_follows_the_law() {
        for exponent in [0.5, 1.0, 1.5] {
            let (dt_s, fitted) = (0.1, [3.0, exponent, 0.02]);
            let mut noise = Composite::default();
            PowerLawNoise.compose(&fitted, dt_s, &mut noise);
            for frequency_hz in [1e-4, 1e-3, 1e-2, 0.1, 1.0, 4.0] {
                let sum: f64 =
                    noise.markov.iter().map(|m| m.density(frequency_hz, dt_s, Sampling::Averaging)).sum();
                let bin = ModeBin { frequency_hz, mode: 1, modes: 1, samples: 1000, dt_s, even_ends: false };
                let wanted = PowerLawNoise.density(&fitted, &bin);
                assert!((sum / wanted - 1.0).abs() < 0.06, "{exponent} at {frequency_hz}: {sum} {wanted}");
            }
        }
    }

    #[test]
    fn aliases_are_summed_to_the_end() {
        for exponent in [0.1, 0.7, 1.9] {
            for x in [0.01, 0.2, 0.5_f64] {
                let s = 2.0 + exponent;
                let side = |from: f64| -> f64 {
                    let sum: f64 = (0..3000).map(|k| (from + f64::from(k)).powf(-s)).sum();
                    sum + (from + 2999.5).powf(1.0 - s) / (s - 1.0)
                };
                let sine = (std::f64::consts::PI * x).sin() / std::f64::consts::PI;
                let wanted = sine * sine * x.powf(exponent) * (side(x) + side(1.0 - x));
                let got = averaged(exponent, x);
                assert!((got / wanted - 1.0).abs() < 2e-6, "{exponent} at {x}: {got} {wanted}");
            }
        }
    }
}
