//! A recording at one resolution, in cosine modes: what every fit works on.
//!
//! The residual of the claimed mean is transformed by the orthonormal DCT-II, in which white noise and random walk are
//! diagonal exactly and flicker nearly; the coefficients are then independent with variance S(f_k)/Δt. A record may be
//! cut into blocks of equal length, each transformed by itself and about its own mean.

use super::terms::SpectralTerm;
use crate::claim::Claim;
use crate::effect::{Drivers, ModeBin, Model, Nuisance};
use crate::noise::data::NoiseType;
use crate::noise::model::{Bin, Spectral, bin_ratio, claimed_unit_density};
use crate::numeric::cosine::dct2;
use crate::numeric::order::SortNumbers;
use crate::recording::sensor;
use std::sync::Arc;

/// Modes that have a bin each.
const SINGLE_MODES: usize = 64;
/// Width of the bins above, relative.
const BIN_WIDTH: f64 = 0.006;
/// Most of the modes that are left for one bin.
const TOWARDS_END: f64 = 0.05;

/// A column whose coefficient the claim knows to within a stated deviation.
#[derive(Debug, Clone)]
pub struct NuisanceColumn {
    /// The value of the claim.
    pub nuisance: Nuisance,
    /// Its modes, deg/h for a coefficient of 1.
    pub modes: Vec<f64>,
    /// Its mean in each block, deg/h for a coefficient of 1.
    pub block_means: Vec<f64>,
    /// Stated standard deviation of the coefficient.
    pub deviation: f64,
}

/// A recording at one resolution.
#[derive(Debug, Clone)]
pub struct SpectralData {
    /// Columns and claim on this grid.
    pub drivers: Arc<Drivers>,
    /// Cosine modes of what was observed less the claimed mean, deg/h, block after block. Mode 0 of each, which the
    /// bias takes, is 0.
    pub modes: Vec<f64>,
    /// Samples that each block begins with; all have the length of a bin's `samples`.
    pub blocks: Vec<usize>,
    /// Samples of a block.
    pub length: usize,
    /// Bins of modes.
    pub bins: Vec<ModeBin>,
    /// Densities of N, B, K for a coefficient of 1 in each bin, (deg/h)²/Hz.
    pub units: Vec<[f64; 3]>,
    /// Columns with stated coefficients.
    pub nuisances: Vec<NuisanceColumn>,
}

/// N, B, K in the order of arrays.
pub const BASE_TERMS: [NoiseType; 3] =
    [NoiseType::AngleRandomWalk, NoiseType::Flicker, NoiseType::RateRandomWalk];

/// Least power of a filter whose modes are judged: below it the noise is that of the last digits or of what comes after the
/// filter.
const MIN_FILTER_POWER: f64 = 1e-5;
/// Width of a bin over its distance from the zero of a filter.
const BESIDE_ZERO: f64 = 0.1;

/// Bins of modes, narrow beside the orders of modes in `zeros`.
fn bins(samples: usize, dt_s: f64, zeros: &[f64]) -> Vec<ModeBin> {
    let mut out = vec![];
    let mut mode = 1;
    while mode < samples {
        // Towards the highest mode, too: there the mean of two samples has a zero, which no wide bin describes.
        let left = samples - mode;
        let wide = (mode as f64 * BIN_WIDTH).min(left as f64 * TOWARDS_END) as usize;
        let near = zeros.iter().map(|z| (z - mode as f64).abs()).fold(f64::INFINITY, f64::min);
        let wide = wide.min((near * BESIDE_ZERO) as usize);
        let modes = if mode < SINGLE_MODES { 1 } else { wide.max(1) };
        let middle = mode as f64 + 0.5 * (modes - 1) as f64;
        let frequency_hz = middle / (2.0 * samples as f64 * dt_s);
        out.push(ModeBin { frequency_hz, mode, modes, samples, dt_s, even_ends: false });
        mode += modes;
    }
    out
}

/// Densities of the terms of a claim in a bin. At the sample rate they are what the claim states; averages of many
/// samples show what means over their interval do. `averaged` is how many samples one of the data holds.
fn unit_densities(bin: &ModeBin, averaged: usize) -> [f64; 3] {
    let at = Bin {
        frequency_hz: bin.frequency_hz,
        tau_s: bin.dt_s,
        filling: 1.0,
        mode: bin.mode,
        blocks: bin.samples,
        segment: 0,
    };
    BASE_TERMS.map(|term| match claimed_unit_density(term, bin.frequency_hz) {
        Some(stated) if averaged == 1 => stated * bin_ratio(term, &at),
        _ => term.density(&at),
    })
}

impl SpectralData {
    /// The data of a whole residual, deg/h, on the grid of the drivers. `deviations` are those of the nuisances with a
    /// column.
    pub fn new(
        drivers: impl Into<Arc<Drivers>>,
        residual: &[f64],
        deviations: &[(Nuisance, f64)],
    ) -> SpectralData {
        let drivers = drivers.into();
        let length = drivers.samples;
        SpectralData::of_blocks(drivers, residual, deviations, vec![0], length)
    }

    /// The data of blocks of `length` samples.
    pub fn of_blocks(
        drivers: Arc<Drivers>,
        residual: &[f64],
        deviations: &[(Nuisance, f64)],
        blocks: Vec<usize>,
        length: usize,
    ) -> SpectralData {
        let modes = transform(residual, &blocks, length);
        let bins = bins(length, drivers.dt_s, &[]);
        let units = bins.iter().map(|bin| unit_densities(bin, drivers.averaged)).collect();
        let nuisances = deviations
            .iter()
            .filter(|(_, deviation)| *deviation > 0.0)
            .filter_map(|(nuisance, deviation)| {
                let column = nuisance_column(*nuisance, &drivers)?;
                let modes = transform(&column, &blocks, length);
                let block_means = block_means(&column, &blocks, length);
                Some(NuisanceColumn { nuisance: *nuisance, modes, block_means, deviation: *deviation })
            })
            .collect();
        SpectralData { drivers, modes, blocks, length, bins, units, nuisances }
    }

    /// The same with the columns that effects of the claim leave free, as a state before the record.
    pub fn with_states(mut self, claim: &Claim) -> SpectralData {
        for stated in &claim.effects {
            let Model::Mean(course) = stated.effect.model() else { continue };
            for column in course.nuisance_columns(&stated.values, &self.drivers) {
                self.nuisances.push(NuisanceColumn {
                    nuisance: Nuisance::InitialState,
                    modes: self.transform(&column),
                    block_means: self.block_means(&column),
                    deviation: f64::INFINITY,
                });
            }
        }
        self
    }

    /// The same after the ends of the record were drawn.
    pub fn with_even_ends(mut self, even: bool) -> SpectralData {
        self.bins.iter_mut().for_each(|b| b.even_ends = even);
        self
    }

    /// The same behind filters for which the ends of the record were drawn: without the modes that they leave next to
    /// nothing, and with narrow bins beside their zeros.
    pub fn behind(mut self, filters: &[SpectralTerm]) -> SpectralData {
        let spectra = || {
            filters.iter().filter_map(|f| match f.effect.model() {
                Model::Spectrum(s) => Some((s, &f.fitted)),
                _ => None,
            })
        };
        let (samples, dt_s) = (self.length, self.drivers.dt_s);
        let order = |f: f64| 2.0 * samples as f64 * dt_s * f;
        let zeros: Vec<f64> = spectra().flat_map(|(s, fitted)| s.zeros_hz(fitted, dt_s)).map(order).collect();
        self.bins = bins(samples, dt_s, &zeros);
        self = self.with_even_ends(true);
        for (spectrum, fitted) in spectra() {
            let mut through = spectrum.densities(fitted, &self.bins).into_iter();
            self.bins.retain(|_| through.next().is_none_or(|power| power >= MIN_FILTER_POWER));
        }
        self.units = self.bins.iter().map(|bin| unit_densities(bin, self.drivers.averaged)).collect();
        self
    }

    /// The bins of a record so many times as long at the same rate, without a record and without columns.
    pub fn longer(&self, times: f64) -> SpectralData {
        let samples = (self.length as f64 * times).round() as usize;
        let drivers = Drivers { samples, ..self.drivers.bare() };
        let bins = bins(samples, drivers.dt_s, &[]);
        let units = bins.iter().map(|bin| unit_densities(bin, drivers.averaged)).collect();
        let drivers = Arc::new(drivers);
        SpectralData {
            drivers,
            modes: vec![],
            blocks: vec![0],
            length: samples,
            bins,
            units,
            nuisances: vec![],
        }
    }

    /// True where one block holds all samples.
    pub fn is_whole(&self) -> bool {
        self.blocks == [0] && self.length == self.drivers.samples
    }

    /// Cosine modes of a series on the grid of the drivers, block after block.
    pub fn transform(&self, series: &[f64]) -> Vec<f64> {
        transform(series, &self.blocks, self.length)
    }

    /// Mean of a series on the grid of the drivers in each block.
    pub fn block_means(&self, series: &[f64]) -> Vec<f64> {
        block_means(series, &self.blocks, self.length)
    }

    /// Mean square of modes in each bin as a density, (deg/h)²/Hz.
    pub fn observed(&self, modes: &[f64]) -> Vec<f64> {
        let square = |bin: &ModeBin| {
            let in_block = |b: usize| {
                let at = b * self.length + bin.mode;
                modes.get(at..at + bin.modes).unwrap_or_default().iter().map(|x| x * x).sum::<f64>()
            };
            let sum: f64 = (0..self.blocks.len()).map(in_block).sum();
            sum / (bin.modes * self.blocks.len()) as f64 * bin.dt_s
        };
        self.bins.iter().map(square).collect()
    }

    /// Modes that each bin holds in all blocks.
    pub fn weight(&self, bin: &ModeBin) -> f64 {
        (bin.modes * self.blocks.len()) as f64
    }

    /// Variance of each mode, (deg/h)², from the densities of the bins; infinite for mode 0 and where no bin is.
    pub fn powers(&self, densities: &[f64]) -> Vec<f64> {
        let mut out = vec![f64::INFINITY; self.length * self.blocks.len()];
        for block in out.chunks_exact_mut(self.length) {
            for (bin, density) in self.bins.iter().zip(densities) {
                block[bin.mode..bin.mode + bin.modes].fill(density / bin.dt_s);
            }
        }
        out
    }

    /// Frequency of a mode, Hz.
    pub fn frequency_hz(&self, mode: f64) -> f64 {
        mode / (2.0 * self.length as f64 * self.drivers.dt_s)
    }
}

/// Cosine modes of each block, mode 0 of each set to 0.
fn transform(series: &[f64], blocks: &[usize], length: usize) -> Vec<f64> {
    let of_block = |first: &usize| {
        let mut modes = dct2(series.get(*first..first + length).unwrap_or_default());
        modes.resize(length, 0.0);
        if let Some(first) = modes.first_mut() {
            *first = 0.0;
        }
        modes
    };
    match blocks {
        [whole] => of_block(whole),
        blocks => blocks.iter().flat_map(of_block).collect(),
    }
}

fn block_means(series: &[f64], blocks: &[usize], length: usize) -> Vec<f64> {
    let mean = |first: &usize| {
        series.get(*first..first + length).unwrap_or_default().iter().sum::<f64>() / length.max(1) as f64
    };
    blocks.iter().map(mean).collect()
}

/// The column that a nuisance multiplies, deg/h for a coefficient of 1.
fn nuisance_column(nuisance: Nuisance, drivers: &Drivers) -> Option<Vec<f64>> {
    match nuisance {
        Nuisance::TemperatureCoefficient => drivers.temperature.clone(),
        Nuisance::ScaleFactor => drivers.table_rate.as_ref().map(|c| c.iter().map(|r| 3600e-6 * r).collect()),
        _ => None,
    }
}

/// The part of a series that its spectrum separates from the white noise of a sensor: each cosine mode is weighted by the
/// share of its neighbourhood's power that lies above the floor. Of one that reads in coarse steps, the course between them.
pub fn smoothed(values: &[f64]) -> Vec<f64> {
    if let Some(course) = sensor::between_steps(values) {
        return course;
    }
    let n = values.len();
    if n < 32 {
        return values.to_vec();
    }
    // A line from end to end is taken out first, or its jump at the edges would pass for noise.
    let (first, last) = (edge(&values[..n / 64 + 1]), edge(&values[n - n / 64 - 1..]));
    let line = |i: usize| first + (last - first) * i as f64 / (n - 1) as f64;
    let rest: Vec<f64> = values.iter().enumerate().map(|(i, v)| v - line(i)).collect();
    let mut modes = dct2(&rest);
    let mut high: Vec<f64> = modes[n / 2..].iter().map(|x| x * x).collect();
    high.sort_ascending();
    // The median of χ²₁ is 0.455.
    let floor = high[high.len() / 2] / 0.455;
    let mut from = 1;
    while from < n {
        let to = (from + (from / 8).max(1)).min(n);
        let power = modes[from..to].iter().map(|x| x * x).sum::<f64>() / (to - from) as f64;
        let gain = if power > 3.0 * floor { 1.0 - floor / power } else { 0.0 };
        modes[from..to].iter_mut().for_each(|x| *x *= gain);
        from = to;
    }
    crate::numeric::cosine::inverse_dct2(&modes).iter().enumerate().map(|(i, v)| v + line(i)).collect()
}

fn edge(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn bins_hold_every_mode_once_and_narrow_towards_zeros_of_a_filter() {
        for zeros in [vec![], vec![700.0, 2000.0]] {
            let bins = bins(5000, 0.1, &zeros);
            assert_eq!(bins.iter().map(|b| b.modes).sum::<usize>(), 4999);
            assert!(bins.windows(2).all(|w| w[0].mode + w[0].modes == w[1].mode));
            for zero in &zeros {
                let at = bins.iter().find(|b| ((b.mode + b.modes) as f64) > *zero).unwrap();
                assert!(at.modes <= 2, "{at:?}");
            }
        }
        // Mode 1000 of 5000 samples at 10 Hz lies at 1 Hz.
        let bin = bins(5000, 0.1, &[]).into_iter().find(|b| b.mode + b.modes > 1000).unwrap();
        assert!((bin.frequency_hz - 1.0).abs() < 0.005);
    }

    #[test]
    fn powers_and_observed_densities_are_each_other() {
        let series: Vec<f64> = (0..400).map(|i| f64::from(i * 37 % 101) - 50.0).collect();
        let drivers = Drivers { dt_s: 0.5, samples: 400, averaged: 1, ..Drivers::default() };
        let spectral = SpectralData::new(drivers, &series, &[]);
        let observed = spectral.observed(&spectral.modes);
        // All modes but the mean hold the variance of the series (Parseval).
        let total: f64 =
            spectral.bins.iter().zip(&observed).map(|(b, s)| spectral.weight(b) * s / b.dt_s).sum();
        let mean = series.iter().sum::<f64>() / 400.0;
        let variance: f64 = series.iter().map(|x| (x - mean).powi(2)).sum();
        assert!((total / variance - 1.0).abs() < 1e-9);
        let powers = spectral.powers(&observed);
        assert!(powers[0].is_infinite() && (powers[1] - spectral.modes[1].powi(2)).abs() < 1e-9 * powers[1]);
    }

    #[test]
    fn a_line_in_sensor_noise_is_kept_and_the_noise_is_not() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
        let values: Vec<f64> = (0..4000).map(|i| 20.0 + 0.01 * i as f64 + 0.5 * noise()).collect();
        let smooth = smoothed(&values);
        let off = |v: &[f64]| {
            let square: f64 = v.iter().enumerate().map(|(i, x)| (x - 20.0 - 0.01 * i as f64).powi(2)).sum();
            (square / 4000.0).sqrt()
        };
        assert!(off(&smooth) < 0.25 * off(&values), "{} {}", off(&smooth), off(&values));
        assert_eq!(smoothed(&values[..10]), values[..10]);
    }
}
