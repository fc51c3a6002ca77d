//! Recording and claim brought together: residual, spectral data, and the claim's own fit.

use super::corner::{most_about_corners, round_corner};
use super::departures::{self, Departure};
use super::finding::UnusableColumn;
use super::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use super::hypothesis::{Hypothesis, fit};
use super::impute;
use super::noise_fit::Noise;
use super::quantization_grid::{self, QuantizationGrid};
use super::regular::{Grid, Regular};
use super::spectral_data::{SpectralData, smoothed};
use super::terms::SpectralTerm;
use super::usable::unusable;
use crate::claim::{Claim, Stated};
use crate::effect::{
    Column, Detector, Drivers, Effect, JumpDetector, Model, Nuisance, OtherDriver, Param, Values, number,
};
use crate::noise::model::NoiseModel;
use crate::numeric::cosine::{fast_length, inverse_dct2};
use crate::recording::sensor;
use std::sync::Arc;

/// Samples up to which a record is looked at in one resolution.
const MAX_SINGLE_RESOLUTION: usize = 16_384;
/// Samples of the averages of a longer one, at most.
const MAX_AVERAGES: usize = 12_288;
/// Seed of imputed places: a report is a function of recording and claim alone.
const IMPUTATION_SEED: u64 = 0x5a67_6e61_6320_0005;

/// Squared error of a size, over its variance, from which missing samples are imputed again: the error that comes from imputing them
/// without the course.
const REIMPUTE_TOLERANCE: f64 = 0.1;
/// Most iterations of imputation and fit. Each reduces the error to the share of the missing samples.
const MAX_ITERATIONS: usize = 12;

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
    /// Columns without a role of their own that cannot drive anything, and why.
    pub unusable: Vec<(Column, UnusableColumn)>,
    /// The grid that the values lie on.
    pub quantization_grid: Option<QuantizationGrid>,
    /// Number of samples that are set aside about round corners.
    about_corners: usize,
    /// The filters, stated or found, for which the ends of the record were drawn.
    filters: Vec<SpectralTerm>,
    /// Both resolutions.
    pub spectra: SpectralDataSet,
}

impl Problem {
    /// Brings a recording and a claim together.
    pub fn new(regular: &Regular, claim: &Claim) -> Problem {
        let mut drivers = drivers(regular, claim);
        let mean = drivers.claimed_mean();
        let mut residual: Vec<f64> = regular.rate.iter().zip(&mean).map(|(y, m)| y - m).collect();
        for stated in &claim.effects {
            let course = match stated.effect.model() {
                Model::Mean(c) => c.course(&stated.values, &drivers),
                _ => stated.effect.claimed_course(&stated.values, &drivers),
            };
            if let Some(course) = course {
                residual.iter_mut().zip(&course).for_each(|(r, c)| *r -= c);
            }
        }
        let mut usable = regular.grid.present.clone();
        let mut about_corners = 0;
        for stated in &claim.effects {
            let named = |p: &Param| number(&stated.values, p.name).unwrap_or(f64::NAN);
            let parameters: Vec<f64> = stated.effect.params().iter().map(named).collect();
            let aside = curvature_within_average(stated.effect, &parameters, &drivers);
            aside.into_iter().for_each(|i| usable[i] = false);
            let most = most_about_corners(usable.len(), about_corners);
            let about_corner = corner(stated.effect, &parameters, &drivers, &residual, &usable, most);
            about_corners += about_corner.len();
            about_corner.into_iter().for_each(|i| usable[i] = false);
        }
        let rows = usable.iter().filter(|u| **u).count();
        // A response to the sensed rate follows the bias that the gyro has, of which the claim knows only so much.
        let seen = residual.iter().zip(&usable).filter(|(_, u)| **u).map(|(r, _)| r);
        drivers.claim.bias_deg_h = seen.sum::<f64>() / rows.max(1) as f64;
        let drivers = Arc::new(drivers);
        let level = level(claim, &drivers);
        let mut claim = claim.clone();
        if let Some((_, rms)) = &level {
            claim.noise = scaled(claim.noise, *rms);
        }
        let quantization_grid = quantization_grid::of(regular);
        let grid_step_arcsec = quantization_grid.map(|l| l.increment_arcsec);
        let noise = Noise::of(&claim);
        let filters: Vec<SpectralTerm> = noise.filters().cloned().collect();
        let even_ends = set_ends_aside(&mut usable, &filters, drivers.dt_s);
        let empty = SpectralData::new(drivers.clone(), &residual, &[]).with_even_ends(even_ends);
        let powers = empty.powers(&noise.densities(&empty));
        impute::fill(&mut residual, &usable, &powers, IMPUTATION_SEED);
        let spectra = spectra(&drivers, &claim, &residual, &filters, grid_step_arcsec, rows);
        let level = level.map(|(level, _)| level);
        let others = regular.columns.iter().filter(|(c, _)| c.is_other());
        let unusable = others.filter_map(|(c, values)| Some((*c, unusable(values)?))).collect();
        Problem {
            grid: regular.grid.clone(),
            claim,
            drivers,
            residual,
            usable,
            level,
            unusable,
            quantization_grid,
            about_corners,
            filters,
            spectra,
        }
    }

    /// True where samples are set aside about a round corner.
    pub fn has_round_corner(&self) -> bool {
        self.about_corners > 0
    }

    /// The effect of jumps that the claim states without saying when, with what it states.
    pub fn stated_jumps(&self) -> Option<(&'static dyn JumpDetector, &Values)> {
        let of = |e: &Stated| match e.effect.detector() {
            Some(Detector::Jumps(detector)) => Some(detector),
            _ => None,
        };
        let (detector, stated) = self.claim.effects.iter().find_map(|e| Some((of(e)?, e)))?;
        let known = stated.effect.claimed_course(&stated.values, &self.drivers).is_some();
        (!known).then_some((detector, &stated.values))
    }

    /// Departures of the recording from a hypothesis; `level` is that of the noise in each sample, where it changes.
    pub fn departures(&self, tried: &FittedHypothesis, level: Option<&[f64]>) -> Vec<Departure> {
        departures::all(&self.spectra, tried, level, &self.usable, self.claim.uncertainty.skewness)
    }

    /// Probability of as large a departure from a hypothesis by any test of its residual.
    pub fn departure_probability(&self, tried: &FittedHypothesis) -> f64 {
        departures::family(&self.departures(tried, self.level.as_deref()), &self.drivers)
    }

    /// A hypothesis fitted to what the problem has become.
    pub fn refitted(&self, tried: &FittedHypothesis) -> FittedHypothesis {
        let mut hypothesis = tried.hypothesis.clone();
        let fit = fit(&mut hypothesis, &self.spectra.full);
        FittedHypothesis { hypothesis, fit, ..tried.clone() }
    }

    /// Takes a course out of the residual.
    pub fn take(&mut self, course: &[f64]) {
        self.residual.iter_mut().zip(course).for_each(|(r, c)| *r -= c);
        self.retransform();
    }

    /// Draws the ends of the record anew where the filters of a hypothesis make them different from noise that is even about them;
    /// true where that was not done for such filters before. Their few samples are in every mode that a filter leaves next
    /// to nothing, which a likelihood of independent modes does not know. `mean` is fitted to the problem as it is.
    pub fn impute_edges(&mut self, mean: &FittedHypothesis, tried: &FittedHypothesis) -> bool {
        let noise = &tried.hypothesis.noise;
        let filters: Vec<SpectralTerm> = noise.filters().cloned().collect();
        if same_filters(&filters, &self.filters)
            || !set_ends_aside(&mut self.usable, &filters, self.drivers.dt_s)
        {
            return false;
        }
        self.residual = self.drawn(mean, noise, &self.usable);
        self.filters = filters;
        self.retransform();
        true
    }

    /// Spectral data with the ends of the record drawn for the filters of a noise.
    pub fn edges_imputed(&self, mean: &FittedHypothesis, noise: &Noise) -> SpectralData {
        let filters: Vec<SpectralTerm> = noise.filters().cloned().collect();
        let mut usable = self.usable.clone();
        set_ends_aside(&mut usable, &filters, self.drivers.dt_s);
        full(&self.drivers, &self.claim, &self.drawn(mean, noise, &usable), &filters)
    }

    /// The residual with a draw of a noise where no sample is usable. The mean of a fit is taken out while filling, or the
    /// draw would not hold it.
    fn drawn(&self, mean: &FittedHypothesis, noise: &Noise, usable: &[bool]) -> Vec<f64> {
        let filters: Vec<SpectralTerm> = noise.filters().cloned().collect();
        let rest = inverse_dct2(&mean.residual(&self.spectra));
        let even_ends = has_ends_aside(&filters, self.drivers.dt_s);
        let spectral = SpectralData::new(self.drivers.clone(), &rest, &[]).with_even_ends(even_ends);
        let mut filled = rest.clone();
        impute::fill(&mut filled, usable, &spectral.powers(&noise.densities(&spectral)), IMPUTATION_SEED);
        let change = filled.iter().zip(&rest).zip(usable).map(|((f, r), u)| if *u { 0.0 } else { f - r });
        self.residual.iter().zip(change).map(|(r, c)| r + c).collect()
    }

    fn retransform(&mut self) {
        let SpectralDataSet { grid_step_arcsec, rows, repeated_share, .. } = self.spectra;
        self.spectra =
            spectra(&self.drivers, &self.claim, &self.residual, &self.filters, grid_step_arcsec, rows);
        self.spectra.repeated_share = repeated_share;
    }

    /// The same with more samples set aside and the noise of a hypothesis for what is filled in.
    pub fn without(&mut self, aside: &[usize], tried: &FittedHypothesis) {
        aside.iter().for_each(|i| self.usable[*i] = false);
        self.residual = self.drawn(tried, &tried.hypothesis.noise, &self.usable);
        self.retransform();
    }

    /// Draws the places of missing rows anew about a hypothesis, and fits it again, until both agree; true where they moved. Samples
    /// that were set aside beside them are drawn anew too, but do not ask for it: what they stand in is often known badly.
    ///
    /// They were drawn about the claim. A course is then missing from them, and so many samples speak against it: its size
    /// comes out too small by their share, and where it is large the noise too large and other effects too small.
    pub fn reimpute_until_stable(&mut self, tried: &FittedHypothesis) -> bool {
        let in_gaps = self.grid.places_in_gaps().into_iter();
        let missing: Vec<usize> = in_gaps.filter(|i| self.usable.get(*i) == Some(&false)).collect();
        if missing.is_empty() || tried.hypothesis.courses.is_empty() {
            return false;
        }
        let left = tried.residual(&self.spectra);
        let taken: Vec<f64> = self.spectra.full.modes.iter().zip(&left).map(|(b, l)| b - l).collect();
        let of_course = inverse_dct2(&taken);
        let share = missing.len() as f64 / self.usable.len() as f64;
        let error = |problem: &Problem, course: &[f64], tried: &FittedHypothesis| {
            2.0 * share * problem.nats(&missing, course, tried)
        };
        if error(self, &of_course, tried) < REIMPUTE_TOLERANCE {
            return false;
        }
        let mut moved = false;
        let mut tried = tried.clone();
        for _ in 0..MAX_ITERATIONS {
            let drawn = self.drawn(&tried, &tried.hypothesis.noise, &self.usable);
            let change: Vec<f64> = drawn.iter().zip(&self.residual).map(|(d, r)| d - r).collect();
            if error(self, &change, &tried) < 0.1 * REIMPUTE_TOLERANCE {
                break;
            }
            moved = true;
            self.spectra.repeated_share = share;
            self.residual = drawn;
            self.retransform();
            tried = self.refitted(&tried);
        }
        moved
    }

    /// Information of some samples on a course against the white part of a fitted noise, nats.
    fn nats(&self, samples: &[usize], course: &[f64], tried: &FittedHypothesis) -> f64 {
        let powers = tried.powers(&self.spectra);
        // Modes that a filter leaves next to nothing are not judged.
        let upper: Vec<f64> = powers[powers.len() / 2..].iter().copied().filter(|p| p.is_finite()).collect();
        let variance = upper.iter().sum::<f64>() / upper.len().max(1) as f64;
        samples.iter().map(|i| course[*i].powi(2)).sum::<f64>() / (2.0 * variance)
    }

    /// Sets the samples aside of which the columns do not tell the courses of a hypothesis, and draws what is set aside anew about them;
    /// true where there are any.
    pub fn without_bends(&mut self, tried: &FittedHypothesis) -> bool {
        let left = inverse_dct2(&tried.residual(&self.spectra));
        let (mut aside, mut about) = (vec![], vec![]);
        for course in &tried.hypothesis.courses {
            let Model::Mean(model) = course.effect.model() else { continue };
            let parameters =
                model.parameters(&course.nonlinear_parameters, &course.coefficients, &self.drivers);
            aside.extend(curvature_within_average(course.effect, &parameters, &self.drivers));
            let most = most_about_corners(self.usable.len(), self.about_corners + about.len());
            about.extend(corner(course.effect, &parameters, &self.drivers, &left, &self.usable, most));
        }
        self.about_corners += about.len();
        aside.extend(about);
        if aside.is_empty() && !self.has_round_corner() {
            return false;
        }
        self.without(&aside, tried);
        true
    }

    /// Stated deviations of the nuisances that have a column.
    pub fn deviations(&self) -> [(Nuisance, f64); 2] {
        deviations(&self.claim)
    }

    /// The claim alone, its nuisances fitted under their priors.
    pub fn baseline(&self) -> FittedHypothesis {
        self.baseline_with(None)
    }

    /// The same with one more stated effect on the spectrum.
    pub fn baseline_with(&self, stated: Option<SpectralTerm>) -> FittedHypothesis {
        let mut noise = Noise::of(&self.claim);
        noise.spectra.extend(stated);
        let mut hypothesis = Hypothesis { noise, courses: vec![] };
        let fit = fit(&mut hypothesis, &self.spectra.full);
        FittedHypothesis { hypothesis, fit, parameters: 0, odds: vec![] }
    }
}

/// Samples for which averaged columns do not determine the course of an effect; none where that would be a good part of the record.
fn curvature_within_average(effect: &dyn Effect, parameters: &[f64], drivers: &Drivers) -> Vec<usize> {
    const MAX_SHARE: f64 = 0.05;
    let Model::Mean(course) = effect.model() else { return vec![] };
    let samples = course.curvature_within_average(parameters, drivers);
    if samples.len() as f64 > MAX_SHARE * drivers.samples as f64 { vec![] } else { samples }
}

/// Samples about the corner of an effect in which a residual is larger than its noise; none for an effect without a corner.
fn corner(
    effect: &dyn Effect,
    parameters: &[f64],
    drivers: &Drivers,
    residual: &[f64],
    usable: &[bool],
    most: usize,
) -> Vec<usize> {
    let Model::Mean(course) = effect.model() else { return vec![] };
    let distance = course.distance_from_corner(parameters, drivers);
    distance.map_or_else(Vec::new, |distance| round_corner(&distance, residual, usable, most))
}

/// Samples at either end that filters make different from noise that is even about the ends.
fn edge_effect(filters: &[SpectralTerm], dt_s: f64) -> usize {
    let of = |filter: &SpectralTerm| match filter.effect.model() {
        Model::Spectrum(s) => s.edge_effect(&filter.fitted, dt_s),
        _ => 0,
    };
    filters.iter().map(of).max().unwrap_or(0)
}

fn has_ends_aside(filters: &[SpectralTerm], dt_s: f64) -> bool {
    edge_effect(filters, dt_s) > 0
}

/// Sets the samples aside that filters make different from the rest; true where there are any.
fn set_ends_aside(usable: &mut [bool], filters: &[SpectralTerm], dt_s: f64) -> bool {
    let (n, ends) = (usable.len(), edge_effect(filters, dt_s));
    usable[..ends.min(n)].fill(false);
    usable[n.saturating_sub(ends)..].fill(false);
    ends > 0
}

/// True for two sets of filters whose cutoffs differ by a few per cent at most.
fn same_filters(some: &[SpectralTerm], others: &[SpectralTerm]) -> bool {
    const MAX_CUTOFF_CHANGE: f64 = 0.03;
    let same = |(a, b): (&SpectralTerm, &SpectralTerm)| {
        a.fitted.iter().zip(&b.fitted).all(|(x, y)| (x - y).abs() <= MAX_CUTOFF_CHANGE * x.abs().max(y.abs()))
    };
    some.len() == others.len() && some.iter().zip(others).all(same)
}

/// N, B and K times a factor.
pub(super) fn scaled(noise: NoiseModel, factor: f64) -> NoiseModel {
    NoiseModel { n: noise.n * factor, b: noise.b * factor, k: noise.k * factor, ..noise }
}

/// The level of the noise that stated effects give each sample, scaled to a mean square of 1, and its root mean square
/// over what N, B and K say.
pub(super) fn level(claim: &Claim, drivers: &Drivers) -> Option<(Vec<f64>, f64)> {
    let stated: Vec<&Stated> = claim.effects.iter().filter(|e| e.effect.sets_level()).collect();
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
    let m = samples.div_ceil(MAX_AVERAGES);
    (m, fast_length(samples / m))
}

/// Stated deviations of the nuisances that have a column.
pub(crate) fn deviations(claim: &Claim) -> [(Nuisance, f64); 2] {
    let u = &claim.uncertainty;
    [
        (Nuisance::TemperatureCoefficient, u.temperature_coefficient_deg_h_per_degc),
        (Nuisance::ScaleFactor, u.scale_factor_ppm),
    ]
}

/// The data at the sample rate, the ends drawn for some filters.
fn full(drivers: &Arc<Drivers>, claim: &Claim, residual: &[f64], filters: &[SpectralTerm]) -> SpectralData {
    let whole = SpectralData::new(drivers.clone(), residual, &deviations(claim)).with_states(claim);
    if has_ends_aside(filters, drivers.dt_s) { whole.behind(filters) } else { whole }
}

fn spectra(
    drivers: &Arc<Drivers>,
    claim: &Claim,
    residual: &[f64],
    filters: &[SpectralTerm],
    grid_step_arcsec: Option<f64>,
    rows: usize,
) -> SpectralDataSet {
    let deviations = deviations(claim);
    let full = full(drivers, claim, residual, filters);
    let slow = (drivers.samples > MAX_SINGLE_RESOLUTION).then(|| {
        let (m, n) = slow_grid(drivers.samples);
        let mut slow = drivers.averages(m);
        slow.truncate(n);
        SpectralData::new(slow, &crate::effect::averages(residual, m)[..n], &deviations).with_states(claim)
    });
    SpectralDataSet { full, slow, grid_step_arcsec, rows, repeated_share: 0.0 }
}

pub(super) fn drivers(regular: &Regular, claim: &Claim) -> Drivers {
    let column = |c: Column| regular.columns.get(&c).cloned();
    let temperature = column(Column::Temperature).map(|t| sensor::between_steps(&t).unwrap_or(t));
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
        others: regular
            .columns
            .iter()
            .filter(|(c, values)| c.is_other() && unusable(values).is_none())
            .map(|(c, values)| OtherDriver { column: *c, smooth: smoothed(values), values: values.clone() })
            .collect(),
        claim: claim.mean,
        lines: claim.lines(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::effect::{ClaimedMean, Value, find};

    #[test]
    fn a_stated_level_is_scaled_to_a_mean_square_of_one() {
        let claim = ClaimedMean { bias_deg_h: 4.0, ..ClaimedMean::default() };
        let drivers = Drivers { dt_s: 1.0, samples: 3, claim, ..Drivers::default() };
        let values = Values::from([
            ("knots_time_s".to_owned(), Value::List(vec![0.0, 2.0])),
            ("knots_ratio".to_owned(), Value::List(vec![1.0, 3.0])),
        ]);
        let effect = find("noise_variance_time").unwrap();
        let claim = Claim { effects: vec![Stated { effect, values }], ..empty_claim() };
        let (level, rms) = level(&claim, &drivers).unwrap();
        // Levels 1, 2, 3: a mean square of 14/3.
        let root = (14.0f64 / 3.0).sqrt();
        assert!((rms - root).abs() < 1e-9);
        for (got, expected) in level.iter().zip([1.0, 2.0, 3.0]) {
            assert!((got - expected / root).abs() < 1e-9, "{level:?}");
        }
        assert!(super::level(&empty_claim(), &drivers).is_none());
    }

    fn empty_claim() -> Claim {
        Claim {
            case: String::new(),
            description: Default::default(),
            sample_rate_hz: 1.0,
            columns: None,
            noise: NoiseModel::default(),
            quantization_lsb_arcsec: 0.0,
            mean: ClaimedMean::default(),
            uncertainty: crate::claim::Uncertainty::default(),
            effects: vec![],
        }
    }

    #[test]
    fn long_records_are_looked_at_in_at_most_so_many_averages() {
        let (m, n) = slow_grid(100_000);
        assert!(m == 9 && n <= 100_000 / 9 && n > 11_080, "{m} {n}");
    }

    #[test]
    fn filters_alike_but_for_a_little_need_no_new_draw() {
        let filter = |hz: f64| SpectralTerm {
            effect: find("bandwidth_filter").unwrap(),
            fitted: vec![hz, 1.0],
            stated: false,
        };
        assert!(
            same_filters(&[filter(10.0)], &[filter(10.2)]) && !same_filters(&[filter(10.0)], &[filter(10.4)])
        );
        assert!(same_filters(&[], &[]) && !same_filters(&[], &[filter(1.0)]));
    }
}
