//! The length of a record that decides between an effect and one that serves as well.

use super::finding::Experiment;
use super::fitted_hypothesis::{Candidate, FittedHypothesis, SpectralDataSet};
use super::hypothesis::{PartModes, columns, kept};
use super::noise_fit::{self, Noise};
use super::nonlinear_search::LocalSearch;
use super::select::{Chosen, MIN_DELTA_BIC, Slot};
use super::spectral_data::SpectralData;
use super::terms::MeanTerm;
use crate::effect::{MeanModel, ModeBin, Model};
use crate::estimate::SCORE_ONE_SIDED_95;
use crate::numeric::least_squares::{Normal, subtract};
use crate::numeric::parallel;
use rand::SeedableRng as _;
use rand_distr::{ChiSquared, Distribution as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::borrow::Cow;

/// Records simulated for each length.
const SIMULATED_RECORDS: usize = 60;
/// Of those, how many must tell the two apart.
const MIN_DECIDED: usize = 57;
/// Longest record that is considered, in lengths of this one.
const MAX_TIMES_LONGER: f64 = 128.0;
/// Evaluations of the rival's course while it is brought as near as it comes.
const MAX_EVALUATIONS: usize = 40;
/// Seed of the simulated records: a report is a function of recording and claim alone.
const SIMULATION_SEED: u64 = 0x5a67_6e61_6320_0007;

/// For each effect and each of its equivalents of the same sort, the shortest record that distinguishes them. A process is
/// not weighed against a course: what either does in a longer record depends on what the record holds.
pub fn deciding(chosen: &[Chosen], best: &FittedHypothesis, spectra: &SpectralDataSet) -> Vec<Experiment> {
    let mut out = vec![];
    for one in chosen {
        for rival in &one.equivalents {
            let times_longer = match (one.slot, one.effect.model(), rival.effect.model()) {
                (Slot::Spectrum(_), _, Model::Spectrum(_)) => processes(best, &rival.tried, spectra),
                (Slot::Mean(i), _, Model::Mean(course)) => courses(best, i, rival, course, spectra),
                _ => continue,
            };
            let (kind, against) = (one.effect.kind().to_owned(), rival.effect.kind().to_owned());
            out.push(Experiment { kind, against, times_longer });
        }
    }
    out
}

/// By simulation: spectra are drawn from the hypothesis as longer records would show them, and both are fitted to each.
fn processes(best: &FittedHypothesis, rival: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<f64> {
    let told = |times: f64| {
        let spectral = spectra.full.longer(times);
        let price = (rival.parameters as f64 - best.parameters as f64) * (spectra.rows as f64 * times).ln();
        records_decided(&best.hypothesis.noise, &rival.hypothesis.noise, &spectral, price) >= MIN_DECIDED
    };
    shortest(told)
}

/// Of [`SIMULATED_RECORDS`] spectra drawn from a noise, those that tell it from a rival, both fitted to each. `price` is what BIC charges
/// the rival more.
fn records_decided(own: &Noise, rival: &Noise, spectral: &SpectralData, price: f64) -> usize {
    let densities = own.densities(spectral);
    let decides = |draw: usize| {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(SIMULATION_SEED + draw as u64);
        let power = |(bin, s): (&ModeBin, &f64)| {
            let dof = bin.modes as f64;
            ChiSquared::new(dof).map_or(*s, |law| s * law.sample(&mut rng) / dof)
        };
        let drawn: Vec<f64> = spectral.bins.iter().zip(&densities).map(power).collect();
        let fitted = |noise: &Noise| noise_fit::fit(&mut noise.clone(), spectral, &drawn).log_likelihood;
        2.0 * (fitted(own) - fitted(rival)) + price >= MIN_DELTA_BIC
    };
    parallel::map(SIMULATED_RECORDS, decides).into_iter().filter(|d| *d).count()
}

/// The share of records, 0 to 1, that tell a noise from a rival: the ΔBIC between them is [`MIN_DELTA_BIC`] in favour of the one
/// that is true. `price` is what BIC charges the rival more.
pub(crate) fn share_decided(own: &Noise, rival: &Noise, spectral: &SpectralData, price: f64) -> f64 {
    records_decided(own, rival, spectral, price) as f64 / SIMULATED_RECORDS as f64
}

/// In closed form: the test repeated m times gives m times the squared distance δ² of the course to the nearest that its
/// rival makes, and 2 ln of the likelihood ratio is normal with mean mδ² and deviation 2√m δ.
fn courses(
    best: &FittedHypothesis,
    index: usize,
    rival: &Candidate,
    course: &'static dyn MeanModel,
    spectra: &SpectralDataSet,
) -> Option<f64> {
    let own = best.hypothesis.courses.get(index)?;
    let other = rival.tried.hypothesis.courses.last()?;
    let distance = distance(best, own, other, course, spectra)?;
    let parameters = rival.tried.parameters as f64 - best.parameters as f64;
    let told = |times: f64| {
        let price = parameters * (spectra.rows as f64 * times).ln();
        times * distance - SCORE_ONE_SIDED_95 * 2.0 * (times * distance).sqrt() + price >= MIN_DELTA_BIC
    };
    shortest(told)
}

/// Squared distance, in deviations of the noise, of a fitted course to the nearest of another effect.
fn distance(
    best: &FittedHypothesis,
    own: &MeanTerm,
    other: &MeanTerm,
    course: &'static dyn MeanModel,
    spectra: &SpectralDataSet,
) -> Option<f64> {
    let spectral = spectra.of(own.course()?.resolution());
    let powers = spectral.powers(&best.hypothesis.noise.densities(spectral));
    let parts = PartModes::of_shape(own.course()?, &own.nonlinear_parameters, spectral);
    let mut modes = parts.offset.unwrap_or_else(|| vec![0.0; spectral.modes.len()]);
    for (column, c) in parts.columns.iter().zip(&own.coefficients) {
        subtract(&mut modes, column, -c);
    }
    Some(nearest(&modes, other, course, spectral, &powers).squared)
}

/// Residual of a course after the best fit of a mean model.
pub(crate) struct Nearest {
    /// Its nonlinear parameters.
    pub nonlinear_parameters: Vec<f64>,
    /// Sum of squares of what is left, in deviations of the noise, with the price of nuisances that moved.
    pub squared: f64,
}

/// The nearest course of a mean model to given modes, found from the nonlinear parameters of `rival`; coefficients, bias and
/// the nuisances of the claim are free, the latter under their priors.
pub(crate) fn nearest(
    modes: &[f64],
    rival: &MeanTerm,
    course: &dyn MeanModel,
    spectral: &SpectralData,
    powers: &[f64],
) -> Nearest {
    let nuisances = kept(spectral, std::slice::from_ref(rival));
    let left = |nonlinear_parameters: &[f64]| {
        let parts = PartModes::of_shape(course, nonlinear_parameters, spectral);
        let mut data = Cow::Borrowed(modes);
        if let Some(fixed) = &parts.offset {
            subtract(data.to_mut(), fixed, 1.0);
        }
        Normal::new(&columns(&nuisances, [&parts]), &data, powers).solve().2
    };
    let local = LocalSearch::of(course, &spectral.drivers);
    let start = &rival.nonlinear_parameters;
    let (nonlinear_parameters, found) = match start.as_slice() {
        [] => (vec![], -left(&[])),
        start => local.refine(start, MAX_EVALUATIONS, |s| -left(s)),
    };
    Nearest { nonlinear_parameters, squared: (-found).max(0.0) }
}

/// Nonlinear parameters of a mean model that a local search moves.
pub(crate) fn free_parameters(course: &dyn MeanModel, spectral: &SpectralData) -> usize {
    LocalSearch::of(course, &spectral.drivers).free()
}

/// The shortest record, in lengths of this one, for which `told` is true: by doubling, then between the last two. `None`
/// where no record up to [`MAX_TIMES_LONGER`] will do.
fn shortest(told: impl Fn(f64) -> bool) -> Option<f64> {
    let mut high = 1.0;
    while !told(high) {
        high *= 2.0;
        if high > MAX_TIMES_LONGER {
            return None;
        }
    }
    let mut low = 0.5 * high;
    for _ in 0..if high > 1.0 { 3 } else { 0 } {
        let middle = (low * high).sqrt();
        if told(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Drivers, find};
    use crate::mismatch::hypothesis::{Hypothesis, fit};
    use crate::mismatch::terms::SpectralTerm;

    const N: f64 = 0.004;

    fn white() -> Noise {
        Noise {
            base: [N, 0.0, 0.0],
            claimed: [N, 0.0, 0.0],
            bound: [0.0; 3],
            deviation: [0.0; 3],
            unconstrained: [false; 3],
            quantization_arcsec: 0.0,
            spectra: vec![],
            discrepancy: None,
        }
    }

    fn spectra(samples: usize) -> SpectralDataSet {
        let drivers = Drivers { dt_s: 1.0, samples, averaged: 1, ..Drivers::default() };
        let full = SpectralData::new(drivers, &vec![0.0; samples], &[]);
        SpectralDataSet { full, slow: None, grid_step_arcsec: None, rows: samples, repeated_share: 0.0 }
    }

    fn tried(
        noise: Noise,
        courses: Vec<MeanTerm>,
        parameters: usize,
        spectra: &SpectralDataSet,
    ) -> FittedHypothesis {
        let mut hypothesis = Hypothesis { noise, courses };
        let kept = hypothesis.clone();
        let fit = fit(&mut hypothesis, &spectra.full);
        FittedHypothesis { hypothesis: kept, fit, parameters, odds: vec![] }
    }

    /// A Markov process of known size against flicker: as many records of the length found, drawn and fitted anew with
    /// another seed, tell the two apart as were asked for, and of half the length fewer.
    #[test]
    fn records_of_that_length_decide_between_processes() {
        let spectra = spectra(8192);
        let with = |kind: &str, fitted: Vec<f64>| {
            let mut noise = white();
            noise.spectra.push(SpectralTerm { effect: find(kind).unwrap(), fitted, stated: false });
            noise
        };
        // A correlation time of 60 s, a third of the noise of a sample.
        let markov = tried(with("markov_long", vec![60.0, 0.08]), vec![], 2, &spectra);
        let mut unconstrained = with("excess_flicker", vec![0.1]);
        (unconstrained.base[1], unconstrained.unconstrained[1]) = (0.1, true);
        let flicker = tried(unconstrained, vec![], 1, &spectra);
        let times = processes(&markov, &flicker, &spectra).unwrap();
        assert!((1.0..=MAX_TIMES_LONGER).contains(&times), "{times}");
        let decided = |times: f64| {
            let spectral = spectra.full.longer(times);
            let densities = markov.hypothesis.noise.densities(&spectral);
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(77);
            let price = -(8192.0 * times).ln();
            (0..60)
                .filter(|_| {
                    let drawn: Vec<f64> = spectral
                        .bins
                        .iter()
                        .zip(&densities)
                        .map(|(b, s)| {
                            let dof = b.modes as f64;
                            s * ChiSquared::new(dof).unwrap().sample(&mut rng) / dof
                        })
                        .collect();
                    let fitted = |t: &FittedHypothesis| {
                        let mut noise = t.hypothesis.noise.clone();
                        noise_fit::fit(&mut noise, &spectral, &drawn).log_likelihood
                    };
                    2.0 * (fitted(&markov) - fitted(&flicker)) + price >= MIN_DELTA_BIC
                })
                .count()
        };
        assert!(decided(times) >= 52, "{} of 60 at {times}", decided(times));
        assert!(decided(0.5 * times) < 57, "{} of 60 at half of {times}", decided(0.5 * times));
    }

    /// A linear drift and an exponential of a long time constant, told apart when the quadratic part shows.
    #[test]
    fn the_distance_of_courses_gives_the_length() {
        let spectra = spectra(4096);
        let course = |kind: &str, nonlinear_parameters: Vec<f64>, coefficients: Vec<f64>| MeanTerm {
            effect: find(kind).unwrap(),
            nonlinear_parameters,
            coefficients,
            states: vec![],
        };
        let warm = course("warmup_exponential", vec![1500.0], vec![0.05]);
        let ramp = course("rate_ramp", vec![], vec![-0.05]);
        let best = tried(white(), vec![warm.clone()], 2, &spectra);
        let Model::Mean(linear) = ramp.effect.model() else { panic!("a course") };
        let squared = distance(&best, &warm, &ramp, linear, &spectra).unwrap();
        // Closed form: white noise of 60 N √f; a line through the exponential by least squares.
        let (n, tau, deviation) = (4096usize, 1500.0, 60.0 * N);
        let x: Vec<f64> = (0..n).map(|i| i as f64 - 2047.5).collect();
        let y: Vec<f64> = (0..n).map(|i| 0.05 * (-(i as f64) / tau).exp()).collect();
        let mean = y.iter().sum::<f64>() / n as f64;
        let slope = x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>() / x.iter().map(|x| x * x).sum::<f64>();
        let left: f64 = x.iter().zip(&y).map(|(x, y)| (y - mean - slope * x).powi(2)).sum();
        assert!((squared / (left / deviation.powi(2)) - 1.0).abs() < 0.02, "{squared}");
        // Two names of one column cannot be told apart by any length.
        let step = course("bias_step", vec![2000.0], vec![0.4]);
        let best = tried(white(), vec![step.clone()], 2, &spectra);
        let Model::Mean(same) = find("heading_change").unwrap().model() else { panic!("a course") };
        let heading = course("heading_change", vec![2000.0], vec![0.4]);
        assert!(distance(&best, &step, &heading, same, &spectra).unwrap() < 1e-3);
    }
}
