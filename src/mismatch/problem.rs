//! Recording and claim brought together: residual, scenes, and the claim's own fit.

use super::candidates::{Scenes, Tried};
use super::hypothesis::{Hypothesis, fit};
use super::impute;
use super::lattice;
use super::noise_fit::{Noise, SpectrumIn};
use super::regular::{Grid, Regular, fast_length};
use super::scene::{Scene, smoothed};
use crate::claim::{Claim, Stated};
use crate::effect::{Column, Drivers, Model, Nuisance, number};
use crate::noise::model::NoiseModel;
use crate::numeric::cosine::inverse_dct2;
use std::sync::Arc;

/// Samples up to which a record is looked at in one resolution.
const WHOLE: usize = 16_384;
/// Samples of the averages of a longer one, at most.
const AVERAGES: usize = 12_288;
/// Seed of imputed places: a report is a function of recording and claim alone.
const SEED: u64 = 0x5a67_6e61_6320_0005;

/// Recording and claim.
pub struct Problem {
    /// The grid of the recording.
    pub grid: Grid,
    /// The claim, its noise as it is on the average of the record where its level changes.
    pub claim: Claim,
    /// Columns on the grid.
    pub drivers: Arc<Drivers>,
    /// Rate less claimed mean and stated courses, deg/h; places without a usable sample hold a draw.
    pub residual: Vec<f64>,
    /// True where the residual is that of a row that counts.
    pub usable: Vec<bool>,
    /// Level of the noise that the claim states, of each sample over that of the record.
    pub level: Option<Vec<f64>>,
    /// Both resolutions.
    pub scenes: Scenes,
}

impl Problem {
    /// Brings a recording and a claim together.
    pub fn new(regular: &Regular, claim: &Claim) -> Problem {
        let drivers = Arc::new(drivers(regular, claim));
        let mean = drivers.claimed_mean();
        let mut residual: Vec<f64> = regular.rate.iter().zip(&mean).map(|(y, m)| y - m).collect();
        for stated in &claim.effects {
            let course = match stated.effect.model() {
                Model::Course(c) => c.course(&stated.values, &drivers),
                _ => stated.effect.stated_course(&stated.values, &drivers),
            };
            if let Some(course) = course {
                residual.iter_mut().zip(&course).for_each(|(r, c)| *r -= c);
            }
        }
        let usable = regular.grid.present.clone();
        let level = level(claim, &drivers);
        let mut claim = claim.clone();
        if let Some((_, rms)) = &level {
            claim.noise = scaled(claim.noise, *rms);
        }
        let lattice_arcsec = lattice::of(regular).map(|l| l.increment_arcsec);
        let rows = usable.iter().filter(|u| **u).count();
        let empty = Scene::new(drivers.clone(), &residual, &[]);
        let noise = Noise::of(&claim);
        let powers = empty.powers(&noise.densities(&empty));
        impute::fill(&mut residual, &usable, &powers, SEED);
        let scenes = scenes(&drivers, &claim, &residual, lattice_arcsec, rows);
        let level = level.map(|(level, _)| level);
        Problem { grid: regular.grid.clone(), claim, drivers, residual, usable, level, scenes }
    }

    /// Size of the jumps (deg/h) and mean time at a level (s) where the claim states jumps between two levels without
    /// saying when.
    pub fn stated_telegraph(&self) -> Option<(f64, f64)> {
        let stated = self.claim.effects.iter().find(|e| e.effect.kind() == "random_telegraph")?;
        let known = stated.effect.stated_course(&stated.values, &self.drivers).is_some();
        let of = |name: &str| number(&stated.values, name);
        Some((of("amplitude_deg_h")?.abs(), of("mean_dwell_s")?)).filter(|_| !known)
    }

    /// Takes a course out of the residual.
    pub fn take(&mut self, course: &[f64]) {
        self.residual.iter_mut().zip(course).for_each(|(r, c)| *r -= c);
        let rows = self.scenes.rows;
        self.scenes = scenes(&self.drivers, &self.claim, &self.residual, self.scenes.lattice_arcsec, rows);
    }

    /// The same with more samples set aside and the noise of a hypothesis for what is filled in.
    pub fn without(&mut self, aside: &[usize], tried: &Tried) {
        aside.iter().for_each(|i| self.usable[*i] = false);
        // The mean of the hypothesis is taken out while filling, or the draw would not hold it.
        let rest = inverse_dct2(&tried.residual(&self.scenes));
        let mut filled = rest.clone();
        impute::fill(&mut filled, &self.usable, &tried.powers(&self.scenes), SEED);
        for i in 0..filled.len() {
            if !self.usable[i] {
                self.residual[i] += filled[i] - rest[i];
            }
        }
        let rows = self.scenes.rows;
        self.scenes = scenes(&self.drivers, &self.claim, &self.residual, self.scenes.lattice_arcsec, rows);
    }

    /// Stated deviations of the nuisances that have a column.
    pub fn deviations(&self) -> [(Nuisance, f64); 2] {
        deviations(&self.claim)
    }

    /// The claim alone, its nuisances fitted under their priors.
    pub fn baseline(&self) -> Tried {
        self.baseline_with(None)
    }

    /// The same with one more stated effect on the spectrum.
    pub fn baseline_with(&self, stated: Option<SpectrumIn>) -> Tried {
        let mut noise = Noise::of(&self.claim);
        noise.spectra.extend(stated);
        let mut hypothesis = Hypothesis { noise, courses: vec![] };
        let fit = fit(&mut hypothesis, &self.scenes.full);
        Tried { hypothesis, fit, parameters: 0, odds: 0.0 }
    }
}

/// N, B and K times a factor.
pub(super) fn scaled(noise: NoiseModel, factor: f64) -> NoiseModel {
    NoiseModel { n: noise.n * factor, b: noise.b * factor, k: noise.k * factor, ..noise }
}

/// The level of the noise that stated effects give each sample, scaled to a mean square of 1, and its root mean square
/// over what N, B and K say.
pub(super) fn level(claim: &Claim, drivers: &Drivers) -> Option<(Vec<f64>, f64)> {
    let kinds = ["noise_variance_time", "noise_variance_rate"];
    let stated: Vec<&Stated> = claim.effects.iter().filter(|e| kinds.contains(&e.effect.kind())).collect();
    if stated.is_empty() {
        return None;
    }
    // A rate one above its mean shows by what the effect multiplies deviations.
    let mean = drivers.claimed_mean();
    let mut rate: Vec<f64> = mean.iter().map(|m| m + drivers.claim.bias_deg_h + 1.0).collect();
    let mut keep = vec![true; rate.len()];
    for effect in stated {
        if let Model::Samples(s) = effect.effect.model() {
            s.apply(&effect.values, drivers, 0, &mut rate, &mut keep);
        }
    }
    let mut level: Vec<f64> =
        rate.iter().zip(&mean).map(|(y, m)| (y - m - drivers.claim.bias_deg_h).abs().max(1e-6)).collect();
    let root = (level.iter().map(|g| g * g).sum::<f64>() / level.len().max(1) as f64).sqrt();
    level.iter_mut().for_each(|g| *g /= root);
    Some((level, root))
}

/// Samples to average and how many averages to keep.
fn slow_grid(samples: usize) -> (usize, usize) {
    let m = samples.div_ceil(AVERAGES);
    (m, fast_length(samples / m))
}

fn deviations(claim: &Claim) -> [(Nuisance, f64); 2] {
    let u = &claim.uncertainty;
    [
        (Nuisance::TemperatureCoefficient, u.temperature_coefficient_deg_h_per_degc),
        (Nuisance::ScaleFactor, u.scale_factor_ppm),
    ]
}

fn scenes(
    drivers: &Arc<Drivers>,
    claim: &Claim,
    residual: &[f64],
    lattice_arcsec: Option<f64>,
    rows: usize,
) -> Scenes {
    let deviations = deviations(claim);
    let full = Scene::new(drivers.clone(), residual, &deviations).with_states(claim);
    let slow = (drivers.samples > WHOLE).then(|| {
        let (m, n) = slow_grid(drivers.samples);
        let mut slow = drivers.averages(m);
        slow.truncate(n);
        Scene::new(slow, &crate::effect::averages(residual, m)[..n], &deviations).with_states(claim)
    });
    Scenes { full, slow, lattice_arcsec, rows }
}

pub(super) fn drivers(regular: &Regular, claim: &Claim) -> Drivers {
    let column = |c: Column| regular.columns.get(&c).cloned();
    let temperature = column(Column::Temperature);
    Drivers {
        dt_s: regular.grid.dt_s,
        start_s: regular.grid.start_s,
        samples: regular.rate.len(),
        averaged: 1,
        smooth_temperature: temperature.as_deref().map(smoothed),
        temperature,
        table_rate: column(Column::TableRate),
        table_angle: column(Column::TableAngle),
        outer_rate: column(Column::OuterRate),
        supply: column(Column::Supply),
        claim: claim.mean,
    }
}
