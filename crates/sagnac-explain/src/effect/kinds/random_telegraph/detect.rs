//! Jumps back and forth between two levels.
//!
//! Levels and rates of change are sought in averages of several lengths and judged by the likelihood of the chain over all
//! its paths, beside the slow noise of the hypothesis. A process with the same spectrum gains by its spectrum alone; only
//! the further gain of the chain distinguishes two levels from it.

use super::chain::{Chain, Deviations};
use super::dwell::{Visits, slope, spread, visits};
use super::path::Paths;
use crate::effect::{Background, FlatResidual, averages};
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::numeric::cosine::{dct2, inverse_dct2};
use crate::numeric::least_squares::Normal;
use crate::numeric::order::SortNumbers;
use crate::numeric::order::upper_median;

/// Most and fewest averages of one length.
const MAX_AVERAGES: usize = 65_536;
const MIN_AVERAGES: usize = 64;
/// Fewest jumps of a telegraph: a level that leaves and returns has two.
const MIN_JUMPS: usize = 3;
/// Iterations of Baum and Welch for each start, and for the best in each round.
const FIRST_ITERATIONS: usize = 5;
const BEST_ITERATIONS: usize = 15;
/// Rounds of path and background.
const PATH_ROUNDS: usize = 8;
/// Most rounds of background and levels at the end, and the relative change of the amplitude at which they end.
const MAX_FINAL_ROUNDS: usize = 40;
const FINAL_TOLERANCE: f64 = 1e-3;
/// Most averages in which paths are corrected stretch by stretch.
const MAX_PATH_AVERAGES: usize = 4096;
/// Normal number of the slope within dwells from which they are no levels: seven in a million by chance.
const MAX_DWELL_SLOPE: f64 = 4.5;
/// Mean square of the departure of dwells from their level, and the logarithm of its probability, from which they are no level.
/// Slow noise that is estimated beside them leaves some.
const MAX_DWELL_SPREAD: f64 = 2.0;
const MIN_LN_DWELL_SPREAD: f64 = -14.0;
/// Least probability of the times at the two levels, if both are left at one rate: below it they are pulses.
const MIN_DWELL_PROBABILITY: f64 = 1e-4;
/// Averages in the shortest period of a drift.
const MIN_DRIFT_AVERAGES: usize = 64;

/// Jumps between two levels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Telegraph {
    /// 0 and 1 for the two levels less their mean, for each sample.
    pub path: Vec<f64>,
    /// Expected value of each sample given all, less the mean, deg/h.
    pub course: Vec<f64>,
    /// Between the levels, deg/h.
    pub amplitude_deg_h: f64,
    /// Its 95 % interval.
    pub amplitude_ci95: [f64; 2],
    /// Mean time at a level, s.
    pub mean_dwell_s: f64,
    /// Its 95 % interval.
    pub dwell_ci95: [f64; 2],
    /// True when the jumps come as regularly as of a periodic course.
    pub regular: bool,
    /// For a level that is left much sooner than the other: its visits.
    pub pulses: Option<Visits>,
    /// Gain of log-likelihood over all paths.
    pub gain: f64,
    /// Gain of the best single process in its place: a Markov process, or flicker or random walk set free.
    pub rival_gain: f64,
    /// Amplitude and the two rates of change.
    pub parameters: usize,
    /// Bound of the probability of such a gain under the hypothesis.
    pub chance: f64,
    /// The same, or of such a gain over the rival where that is the likelier.
    pub p_value: f64,
}

/// Quantities that do not change while paths are tried.
struct PathContext<'a> {
    background: &'a Background<'a>,
    /// Residual of the hypothesis, in time.
    residual: Vec<f64>,
    /// Share of each mode that is slow noise.
    slow: Vec<f64>,
    /// Variance of a sample's white noise, (deg/h)².
    white: f64,
}

/// The size of a known path.
struct Amplitude {
    /// Between the levels, deg/h; negative where the second is the lower.
    size: f64,
    /// Its standard deviation, deg/h.
    deviation: f64,
}

/// A path with its gain.
struct ScoredPath {
    path: Vec<bool>,
    background: Vec<f64>,
    gain: f64,
    chain: Chain,
    averaged: usize,
}

impl<'a> PathContext<'a> {
    fn new(background: &'a Background<'a>) -> PathContext<'a> {
        let powers = &background.powers;
        let mut high: Vec<f64> = powers[powers.len() / 2..].to_vec();
        let white = upper_median(&mut high);
        let slow = |p: &f64| if p.is_finite() { (1.0 - white / p).max(0.0) } else { 0.0 };
        PathContext {
            background,
            residual: inverse_dct2(&background.modes),
            slow: powers.iter().map(slow).collect(),
            white,
        }
    }

    /// Gain of log-likelihood of a chain beside its best background, which costs what the spectrum of the slow noise says.
    /// In white noise it is the likelihood of the chain over that of white noise.
    fn evidence(&self, chain: &Chain, background: &[f64], m: usize) -> f64 {
        let white = self.white;
        let of_background: f64 = dct2(background)
            .iter()
            .zip(&self.slow)
            .filter(|(_, s)| **s > 0.0)
            .map(|(b, s)| b * b * (1.0 - s) / (s * white))
            .sum();
        let beside: f64 = self.residual.iter().zip(background).map(|(r, b)| (r - b).powi(2)).sum();
        // White noise beside the best slow noise: what the spectrum leaves of each mode.
        let alone: f64 = self.background.modes.iter().zip(&self.slow).map(|(x, s)| x * x * (1.0 - s)).sum();
        let values = self.values(background, m);
        let variance = white / m as f64;
        let flat: f64 = values.iter().map(|v| v * v / variance).sum();
        let flat = -0.5 * (flat + values.len() as f64 * (std::f64::consts::TAU * variance).ln());
        let chain = Chain { variance, ..*chain };
        chain.log_likelihood(&values)
            - flat
            - 0.5 * (of_background + (beside - alone) / white)
            - self.background.lost
    }

    /// The best estimate of the slow noise under a path, deg/h.
    fn background(&self, course: &[f64]) -> Vec<f64> {
        let rest: Vec<f64> = self.residual.iter().zip(course).map(|(r, c)| r - c).collect();
        let modes: Vec<f64> = dct2(&rest).iter().zip(&self.slow).map(|(x, s)| x * s).collect();
        inverse_dct2(&modes)
    }

    /// Amplitude of a known path beside the columns of the hypothesis.
    fn amplitude(&self, path: &[bool]) -> Amplitude {
        let series: Vec<f64> = path.iter().map(|p| f64::from(u8::from(*p))).collect();
        let mut modes = dct2(&series);
        modes.iter_mut().take(1).for_each(|first| *first = 0.0);
        let old: Vec<(&[f64], f64)> =
            self.background.columns.iter().map(|(c, d)| (c.as_slice(), *d)).collect();
        let before = Normal::new(&old, &self.background.modes, &self.background.powers);
        let (c, covariance, _) =
            before.with(&old, &[&modes], &self.background.modes, false, &self.background.powers).solve();
        let at = old.len();
        let variance = if covariance.nrows() > at { covariance[(at, at)] } else { 0.0 };
        Amplitude { size: c.get(at).copied().unwrap_or(0.0), deviation: variance.max(0.0).sqrt() }
    }

    /// Expected contribution of a chain of averages of `m` to each sample where `raised` is the probability of its second
    /// level, deg/h.
    fn course(&self, chain: &Chain, m: usize, raised: &[f64], size: f64) -> Vec<f64> {
        let sign = if chain.levels[1] > chain.levels[0] { 1.0 } else { -1.0 };
        let last = raised.len().saturating_sub(1);
        let at = |i: usize| raised.get((i / m).min(last)).copied().unwrap_or(0.0);
        (0..self.residual.len()).map(|i| sign * size * at(i)).collect()
    }

    /// The part that is slower than any dwell sought in averages of `m`.
    fn drift(&self, m: usize) -> Vec<f64> {
        let last = self.residual.len() / (MIN_DRIFT_AVERAGES * m);
        let modes = self.background.modes.iter().zip(&self.slow).enumerate();
        let modes: Vec<f64> = modes.map(|(k, (x, s))| if k <= last { x * s } else { 0.0 }).collect();
        inverse_dct2(&modes)
    }

    /// The best path in averages of `m`, from starts of its own and from a path in longer averages.
    fn search(&self, m: usize, longer: Option<&ScoredPath>) -> Option<ScoredPath> {
        let n = self.residual.len();
        let white = self.white / m as f64;
        let mut background = longer.map_or_else(|| self.drift(m), |j| j.background.clone());
        let mut values = self.values(&background, m);
        let mut chains = starts(&values, white);
        chains.extend(longer.map(|j| j.chain.finer(j.averaged / m)));
        let mut chain = chains
            .into_iter()
            .map(|c| (0..FIRST_ITERATIONS).fold(c, |c, _| c.improved(&values, 0.5 * white)))
            .max_by(|a, b| a.log_likelihood(&values).total_cmp(&b.log_likelihood(&values)))?;
        let mut best: Option<ScoredPath> = None;
        let coloured = self.coloured();
        let mut paths = (coloured && values.len() <= MAX_PATH_AVERAGES).then(|| {
            let powers: Vec<f64> =
                self.background.powers.iter().take(values.len()).map(|p| p / m as f64).collect();
            Paths::new(&averages(&self.residual, m), &powers, white)
        });
        for _ in 0..PATH_ROUNDS {
            chain = (0..BEST_ITERATIONS).fold(chain, |c, _| c.improved(&values, 0.5 * white));
            // Slow noise about the levels would make paths look less certain than they are.
            let sharp = Chain { variance: chain.variance.min(white), ..chain };
            let mut short = sharp.path(&values);
            if let Some(paths) = &mut paths {
                // From nothing as well: a background that was held has hidden stretches, or made them.
                let [kept, anew] = [short, vec![false; values.len()]].map(|path| paths.improved(path));
                short = if anew.0 > kept.0 { anew.1 } else { kept.1 };
            }
            let jumps = short.windows(2).filter(|w| w[0] != w[1]).count();
            if jumps < MIN_JUMPS {
                break;
            }
            let path: Vec<bool> =
                (0..n).map(|i| short.get((i / m).min(short.len() - 1)).copied().unwrap_or(false)).collect();
            // The background that is best beside what is expected of the levels: a turn of expectation and maximum. The
            // levels are those of the path beside any background: in turns, they would close in on them slowly.
            let (sharp, size) = if coloured {
                let size = self.amplitude(&path).size;
                let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
                let sharp = sharp.of_path(&short, size, mean);
                let known: Vec<f64> = short.iter().map(|p| f64::from(u8::from(*p))).collect();
                values = self.values(&self.background(&self.course(&sharp, m, &known, size.abs())), m);
                (sharp, size.abs())
            } else {
                (sharp, sharp.apart())
            };
            let course = self.course(&sharp, m, &sharp.posterior(&values), size);
            background = self.background(&course);
            chain = Chain { variance: chain.variance, ..sharp };
            let gain = self.evidence(&sharp, &background, m);
            if best.as_ref().is_some_and(|b| gain < b.gain + 0.1) {
                break;
            }
            best = Some(ScoredPath { path, background: background.clone(), gain, chain, averaged: m });
            if !coloured {
                break;
            }
            values = self.values(&background, m);
        }
        best
    }

    /// True where the values of each level are the same within its dwells and from one to the next.
    fn is_level(&self, judged: &ScoredPath) -> bool {
        let left: Vec<f64> = self.residual.iter().zip(&judged.background).map(|(r, b)| r - b).collect();
        let spread = spread(&judged.path, &left, self.white);
        let level = spread.ratio < MAX_DWELL_SPREAD || spread.ln_p > MIN_LN_DWELL_SPREAD;
        level && slope(&judged.path, &left, self.white).abs() < MAX_DWELL_SLOPE
    }

    /// True where there is slow noise from which paths must be distinguished.
    fn coloured(&self) -> bool {
        self.slow.iter().any(|s| *s >= 0.02)
    }

    /// Averages of the residual without a background.
    fn values(&self, background: &[f64], m: usize) -> Vec<f64> {
        averages(&self.residual.iter().zip(background).map(|(r, b)| r - b).collect::<Vec<f64>>(), m)
    }
}

/// Looks for a telegraph signal beside a hypothesis.
pub(super) fn telegraph(background: &Background<'_>, rival_gain: &dyn Fn() -> f64) -> Option<Telegraph> {
    let n = background.modes.len();
    let context = PathContext::new(background);
    let finest = n.div_ceil(MAX_AVERAGES).max(1);
    let mut m = finest;
    while n / (4 * m) >= MIN_AVERAGES {
        m *= 4;
    }
    let mut lengths = 0.0f64;
    let mut best: Option<ScoredPath> = None;
    loop {
        lengths += 1.0;
        let found = context.search(m, best.as_ref());
        if let Some(found) = found.filter(|f| best.as_ref().is_none_or(|b| f.gain > b.gain)) {
            best = Some(found);
        }
        if m <= finest {
            break;
        }
        m /= 4;
    }
    let best = best.filter(|b| b.gain > 0.0 && context.is_level(b))?;
    let rival_gain = rival_gain();
    // A likelihood ratio against one fixed law exceeds e^g with a probability below e^−g; each of the three numbers is
    // fitted, ½ ln M nats.
    let log_p = lengths.ln() + 1.5 * ((n / best.averaged) as f64).ln() - best.gain;
    let [chance, p_value] = [log_p, log_p.max(rival_gain - best.gain)].map(|p| p.min(0.0).exp().max(1e-300));
    let result = Telegraph { chance, p_value, ..context.result(best, rival_gain) };
    // Two neighbouring steps of a coarse grid are two levels as well.
    let step = background.grid_step_arcsec.map_or(0.0, |a| a / background.drivers.dt_s);
    let quantization_grid =
        step > FlatResidual::COARSE_STEPS * context.white.sqrt() && result.amplitude_deg_h < 1.5 * step;
    (!quantization_grid).then_some(result)
}

impl PathContext<'_> {
    /// Size and dwell of the best path with their intervals.
    fn result(&self, mut best: ScoredPath, rival_gain: f64) -> Telegraph {
        let n = self.residual.len();
        let mut values = self.values(&best.background, best.averaged);
        // Background and levels in turns, each given the other, from the levels for a known path.
        let coloured = self.coloured();
        let Amplitude { size: known, deviation } = self.amplitude(&best.path);
        let mut size = known.abs();
        let mut raised = best.chain.posterior(&values);
        for _ in 0..if coloured { MAX_FINAL_ROUNDS } else { 0 } {
            let course = self.course(&best.chain, best.averaged, &raised, size);
            values = self.values(&self.background(&course), best.averaged);
            best.chain = (0..BEST_ITERATIONS)
                .fold(best.chain, |c, _| c.improved(&values, 0.5 * self.white / best.averaged as f64));
            raised = best.chain.posterior(&values);
            let before = std::mem::replace(&mut size, best.chain.apart());
            if (size - before).abs() < FINAL_TOLERANCE * size {
                break;
            }
        }
        let step = best.averaged as f64 * self.background.drivers.dt_s;
        let up = best.path.iter().filter(|p| **p).count() as f64;
        let share = up / n as f64;
        size = best.chain.apart();
        let mut course = self.course(&best.chain, best.averaged, &raised, size);
        let mean = course.iter().sum::<f64>() / n as f64;
        course.iter_mut().for_each(|c| *c -= mean);
        let unknown = Deviations { apart: deviation, log_dwell: 1.0 };
        let Deviations { apart: on_chain, log_dwell } = best.chain.deviations(&values).unwrap_or(unknown);
        // The path is uncertain for a known background, and the background for a known path.
        let in_white = self.white / (n as f64 * share * (1.0 - share)).max(1.0);
        let spread = on_chain.powi(2) + (deviation.powi(2) - in_white).max(0.0);
        // A sample in which a jump falls lies between the levels: of dwells of few samples, part is unseen.
        let jumping = 1.0 / best.chain.dwell();
        let half = SCORE_TWO_SIDED_95 * (spread + (0.25 * size * jumping).powi(2)).sqrt();
        let mean_dwell_s = best.chain.dwell() * step;
        let factor = (SCORE_TWO_SIDED_95 * log_dwell.hypot(0.7 * jumping)).exp();
        Telegraph {
            path: best.path.iter().map(|p| f64::from(u8::from(*p)) - share).collect(),
            course,
            amplitude_deg_h: size,
            amplitude_ci95: [(size - half).max(0.0), size + half],
            mean_dwell_s,
            dwell_ci95: [mean_dwell_s / factor, mean_dwell_s * factor],
            regular: regular(&best.path),
            pulses: pulses(&best.path),
            gain: best.gain,
            rival_gain,
            parameters: 3,
            chance: 1.0,
            p_value: 1.0,
        }
    }
}

/// The visits to a level that is left much sooner than the other: pulses.
fn pulses(path: &[bool]) -> Option<Visits> {
    visits(path).filter(|v| v.p_value < MIN_DWELL_PROBABILITY)
}

/// True where the times at both levels are more even than those of independent jumps, whose deviation is their mean.
fn regular(path: &[bool]) -> bool {
    const MIN_DWELLS: usize = 8;
    const MAX_REGULAR_DEVIATION: f64 = 0.5;
    let mut times: [Vec<f64>; 2] = [vec![], vec![]];
    let mut since = None;
    for i in 1..path.len() {
        if path[i] != path[i - 1] {
            if let Some(start) = since {
                times[usize::from(path[i - 1])].push((i - start) as f64);
            }
            since = Some(i);
        }
    }
    times.iter().all(|t| {
        let n = t.len() as f64;
        let mean = t.iter().sum::<f64>() / n;
        let variance = t.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        t.len() >= MIN_DWELLS && variance.sqrt() < MAX_REGULAR_DEVIATION * mean
    })
}

/// Levels at the quarters and at the tenths of the values, with long and short dwells.
fn starts(values: &[f64], white: f64) -> Vec<Chain> {
    if values.is_empty() {
        return vec![];
    }
    let mut sorted = values.to_vec();
    sorted.sort_ascending();
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
    let mut out = vec![];
    for (low, high) in [(0.25, 0.75), (0.05, 0.6), (0.4, 0.95)] {
        for steps in [8.0, 100.0] {
            let levels = [at(low), at(high)];
            if levels[1] > levels[0] {
                let variance = white.max(0.1 * (levels[1] - levels[0]).powi(2));
                out.push(Chain { levels, variance, change: [1.0 / steps; 2] });
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_dwells_are_those_of_a_periodic_course() {
        let even: Vec<bool> = (0..2000).map(|i| i / 50 % 2 == 1).collect();
        assert!(regular(&even));
        // Dwells of 5, 10, 15, ...: their deviation is more than half of their mean.
        let mut uneven = vec![];
        for k in 1..=40 {
            uneven.extend(vec![k % 2 == 0; 5 * k]);
        }
        assert!(!regular(&uneven));
        // Too few to say.
        assert!(!regular(&even[..400]));
    }

    #[test]
    fn the_amplitude_of_a_known_path_is_that_of_least_squares() {
        // White noise of variance ¼; half of 200 samples are raised by 3.
        let path: Vec<bool> = (0..200).map(|i| i / 20 % 2 == 1).collect();
        let series: Vec<f64> = path.iter().map(|p| 3.0 * f64::from(u8::from(*p))).collect();
        let mut modes = dct2(&series);
        modes[0] = 0.0;
        let drivers = crate::effect::Drivers { dt_s: 1.0, samples: 200, ..Default::default() };
        let mut powers = vec![0.25; 200];
        powers[0] = f64::INFINITY;
        let background = Background {
            drivers: &drivers,
            modes,
            powers,
            columns: vec![],
            lost: 0.0,
            grid_step_arcsec: None,
        };
        let context = PathContext::new(&background);
        let Amplitude { size, deviation } = context.amplitude(&path);
        // ¼ over 100 · 100/200 samples' worth.
        assert!(
            (size - 3.0).abs() < 1e-6 && (deviation - 0.005f64.sqrt()).abs() < 1e-6,
            "{size} {deviation}"
        );
        assert!(!context.coloured() && context.white == 0.25);
    }

    /// A background of unit white noise under `residual`, whose first modes are `slow` times as strong.
    fn background<'a>(residual: &[f64], slow: &[f64], drivers: &'a crate::effect::Drivers) -> Background<'a> {
        let mut modes = dct2(residual);
        modes[0] = 0.0;
        let mut powers = vec![1.0; residual.len()];
        powers[0] = f64::INFINITY;
        powers[1..=slow.len()].copy_from_slice(slow);
        Background { drivers, modes, powers, columns: vec![], lost: 0.25, grid_step_arcsec: None }
    }

    #[test]
    fn jumps_in_white_noise_are_found_with_their_size_and_noise_alone_has_none() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let n = 4096;
        let drivers = crate::effect::Drivers { dt_s: 0.5, samples: n, ..Default::default() };
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(11);
        let noise: Vec<f64> = (0..n).map(|_| StandardNormal.sample(&mut rng)).collect();
        assert!(telegraph(&background(&noise, &[], &drivers), &|| 0.0).is_none());
        // Dwells of 40 to 200 samples, 97.5 in the mean, between levels four deviations apart.
        let mut path: Vec<bool> = vec![];
        for (k, dwell) in [40, 130, 70, 55, 200, 90].into_iter().cycle().enumerate() {
            if path.len() >= n {
                break;
            }
            path.extend(vec![k % 2 == 1; dwell]);
        }
        path.truncate(n);
        let residual: Vec<f64> =
            path.iter().zip(&noise).map(|(p, e)| e + 4.0 * f64::from(u8::from(*p))).collect();
        let mut background = background(&residual, &[], &drivers);
        let found = telegraph(&background, &|| 3.0).unwrap();
        assert!((found.amplitude_deg_h - 4.0).abs() < 0.15, "{}", found.amplitude_deg_h);
        assert!(found.amplitude_ci95[0] < 4.0 && 4.0 < found.amplitude_ci95[1], "{:?}", found.amplitude_ci95);
        assert!((found.mean_dwell_s / 48.75 - 1.0).abs() < 0.1, "{}", found.mean_dwell_s);
        assert!(found.dwell_ci95[0] < 48.75 && 48.75 < found.dwell_ci95[1], "{:?}", found.dwell_ci95);
        let share = path.iter().filter(|p| **p).count() as f64 / n as f64;
        let off = found.path.iter().zip(&path).filter(|(f, p)| (**f > 0.0) != **p).count();
        let middle = found.course.iter().sum::<f64>() / n as f64;
        assert!(off < 20 && middle.abs() < 1e-9, "{off} {middle}");
        assert!((found.path.iter().copied().fold(0.0, f64::max) - (1.0 - share)).abs() < 0.01);
        // Half of the square of half the difference for each sample, less what the path costs.
        assert!(found.gain > 1000.0 && found.gain < 0.5 * 4.0 * n as f64, "{}", found.gain);
        assert!(found.chance < 1e-200 && found.p_value == found.chance && found.rival_gain == 3.0);
        // A process that gains as much leaves nothing for jumps; steps of the output are two levels as well.
        assert_eq!(telegraph(&background, &|| 1e9).unwrap().p_value, 1.0);
        background.grid_step_arcsec = Some(0.5 * 3.9);
        assert!(telegraph(&background, &|| 3.0).is_none());
        background.grid_step_arcsec = Some(0.5 * 1.9);
        assert!(telegraph(&background, &|| 3.0).is_some());
    }

    #[test]
    fn the_evidence_of_a_chain_is_its_likelihood_over_that_of_white_noise() {
        let drivers = crate::effect::Drivers { dt_s: 1.0, samples: 64, ..Default::default() };
        let residual: Vec<f64> = (0..64).map(|i| if i / 16 % 2 == 0 { -1.0 } else { 1.0 }).collect();
        let chain = Chain { levels: [-1.0, 1.0], variance: 9.0, change: [0.05, 0.05] };
        for slow in [&[][..], &[4.0, 2.0, 3.0]] {
            let background = background(&residual, slow, &drivers);
            let context = PathContext::new(&background);
            assert_eq!((context.white, context.coloured()), (1.0, !slow.is_empty()));
            // The best slow noise without a path costs what it takes out of the white noise: only the chain is left.
            let beside = context.background(&[0.0; 64]);
            let values: Vec<f64> = residual.iter().zip(&beside).map(|(r, b)| r - b).collect();
            let flat: f64 = values.iter().map(|v| -0.5 * (v * v + std::f64::consts::TAU.ln())).sum();
            let expected = Chain { variance: 1.0, ..chain }.log_likelihood(&values) - flat - 0.25;
            let got = context.evidence(&chain, &beside, 1);
            assert!((got - expected).abs() < 1e-9, "{got} {expected}");
        }
    }

    #[test]
    fn a_drift_is_the_slow_share_of_the_slowest_modes() {
        let drivers = crate::effect::Drivers { dt_s: 1.0, samples: 256, ..Default::default() };
        let residual: Vec<f64> = (0..256).map(|i| ((i * i * 31) % 17) as f64).collect();
        let background = background(&residual, &[4.0, 2.0, 4.0, 1.25, 4.0], &drivers);
        let context = PathContext::new(&background);
        // 256/64 modes for single samples, half of them for averages of two.
        for (m, last) in [(1, 4), (2, 2)] {
            let shares = [0.0, 0.75, 0.5, 0.75, 0.2];
            let mut modes = vec![0.0; 256];
            (1..=last).for_each(|k| modes[k] = shares[k] * background.modes[k]);
            for (got, expected) in context.drift(m).iter().zip(inverse_dct2(&modes)) {
                assert!((got - expected).abs() < 1e-12, "{m}");
            }
        }
    }
}
