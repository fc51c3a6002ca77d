//! The error of a law, as power in the noise of a hypothesis.

use super::spectral_data::SpectralData;

/// The error of a law, as power in the noise.
#[derive(Debug, Clone)]
pub struct Discrepancy {
    /// Kind of the law.
    pub kind: &'static str,
    /// Its share of the law.
    pub share: f64,
    /// Frequency of each bin, Hz.
    pub frequency_hz: Vec<f64>,
    /// Density of the law and its polynomials in each bin, (deg/h)²/Hz.
    pub density: Vec<f64>,
}

impl Discrepancy {
    /// Adds its power to the density of each bin.
    pub fn add_to(&self, densities: &mut [f64], spectral: &SpectralData) {
        for (density, bin) in densities.iter_mut().zip(&spectral.bins) {
            let above = self.frequency_hz.partition_point(|f| *f < bin.frequency_hz);
            let near =
                |i: usize| self.frequency_hz.get(i).map_or(f64::INFINITY, |f| (f - bin.frequency_hz).abs());
            let at = if near(above.wrapping_sub(1)) < near(above) { above - 1 } else { above };
            *density += self.share * self.share * self.density.get(at).copied().unwrap_or(0.0);
        }
    }

    /// Log-likelihood of the law over noise of some density, nats.
    pub fn law_gain(&self, densities: &[f64], spectral: &SpectralData) -> f64 {
        let bins = self.density.iter().zip(densities).zip(&spectral.bins);
        0.5 * bins.map(|((own, noise), bin)| spectral.weight(bin) * own / noise).sum::<f64>()
    }
}
