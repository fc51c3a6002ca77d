//! Stability of one unit over days: runs within days, by a nested model of random effects.
//!
//! `x_ij = μ + β·t_i + d_i + r_ij`: day i has the effect d_i of variance σ_day², run j of it r_ij of variance σ_run². The scatter of
//! runs within days is χ² with as many degrees of freedom as there are runs more than days, whatever the days do. Given σ_run, the
//! weighted square sum Q of the means of days about their line is χ² with two degrees of freedom less than there are days, and
//! falls with σ_day. So the confidence distribution of σ_day is that of the σ_day at which Q is a draw of its χ², over draws of both χ²
//! (Weerahandi 1993; Iyer, Wang and Mathew 2004); where no σ_day makes Q as large, it is zero. The slope is that of the
//! means of days with equal weights. Draws are the middles of even shares of both distributions, so that a result repeats to the bit.

use crate::estimate::student_quantile;
use crate::numeric::order::SortNumbers;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Coverage of the intervals and of bounds.
pub const INTERVAL_COVERAGE: f64 = 0.95;
/// Runs that there must be more than days, for the scatter of a run to be known.
pub const MIN_REPEATS: usize = 3;
/// Days from which the scatter of a day and the trend are known: two more than a line needs.
pub const MIN_DAYS: usize = 4;

/// Even shares of each of both distributions.
const SHARES: usize = 40;
/// Probability of a scatter of days of zero above which none is claimed.
const MAX_ABSENT_PROBABILITY: f64 = 0.05;
/// Coefficients of a line.
const LINE_COEFFICIENTS: usize = 2;
/// Halvings in the search of a root.
const HALVINGS: usize = 60;

/// The runs of one day.
#[derive(Debug, Clone, PartialEq)]
pub struct Day {
    /// When, in the unit of time that the trend is stated in.
    pub time: f64,
    /// Values of its runs.
    pub runs: Vec<f64>,
}

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// What is known of the scatter of days.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DayScatter {
    /// It is there.
    Known(Known),
    /// It may be zero; at 95 % it is at most this.
    AtMost(f64),
}

/// Stability of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stability {
    /// Number of runs.
    pub runs: usize,
    /// Number of days.
    pub days: usize,
    /// Standard deviation of runs of one day; `None` where too few days have several.
    pub run: Option<Known>,
    /// Standard deviation of days beyond that of their runs; `None` where too few days or repeats tell it.
    pub day: Option<DayScatter>,
    /// Change per unit of time; `None` on too few days.
    pub trend: Option<Known>,
}

/// Means of days: time, mean, and number of runs.
struct Means {
    list: Vec<(f64, f64, f64)>,
}

/// The line through the means of days with the weights of a state.
struct Line {
    slope: f64,
    /// Variance of the slope.
    variance: f64,
    /// Weighted square sum about the line.
    about: f64,
}

impl Means {
    /// The line where days have this variance beside that of their runs; `None` where all days have one time.
    fn line(&self, of_day: f64, of_run: f64) -> Option<Line> {
        let weight = |n: f64| 1.0 / (of_day + of_run / n);
        let sum = |f: &dyn Fn(f64, f64) -> f64| {
            self.list.iter().map(|(t, x, n)| weight(*n) * f(*t, *x)).sum::<f64>()
        };
        let total = sum(&|_, _| 1.0);
        let (time, value) = (sum(&|t, _| t) / total, sum(&|_, x| x) / total);
        let square = sum(&|t, _| (t - time).powi(2));
        let slope = sum(&|t, x| (t - time) * (x - value)) / square;
        let about = sum(&|t, x| (x - value - slope * (t - time)).powi(2));
        (square > 0.0 && about.is_finite()).then_some(Line { slope, variance: 1.0 / square, about })
    }

    /// Weighted square sum without a scatter of days over what it is in the mean, at most one.
    fn share_of_expected(&self, of_run: f64, dof: usize) -> Option<f64> {
        self.line(0.0, of_run).map(|l| (l.about / dof as f64).min(1.0))
    }

    /// The variance of days at which the weighted square sum is `asked`; zero where it is smaller without any.
    fn of_day(&self, of_run: f64, asked: f64) -> Option<f64> {
        let about = |of_day: f64| self.line(of_day, of_run).map(|l| l.about);
        if about(0.0)? <= asked {
            return Some(0.0);
        }
        // With weights of one the square sum over the variance is at most this.
        let (mut low, mut high) = (0.0, self.line(1.0, 0.0)?.about / asked);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if about(middle)? > asked { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }
}

/// Middles of even shares of χ² with these degrees of freedom.
fn draws(dof: usize) -> Vec<f64> {
    let Ok(law) = ChiSquared::new(dof as f64) else { return vec![] };
    (0..SHARES).map(|i| law.inverse_cdf((i as f64 + 0.5) / SHARES as f64)).collect()
}

/// The stability of a unit over days in the order of time; days without a run count for nothing.
pub fn stability(days: &[Day]) -> Stability {
    let days: Vec<&Day> = days.iter().filter(|d| !d.runs.is_empty()).collect();
    let runs: usize = days.iter().map(|d| d.runs.len()).sum();
    let means: Vec<(f64, f64, f64)> = days
        .iter()
        .map(|d| (d.time, d.runs.iter().sum::<f64>() / d.runs.len() as f64, d.runs.len() as f64))
        .collect();
    let repeats = runs - days.len();
    let within: f64 =
        days.iter().zip(&means).flat_map(|(d, m)| d.runs.iter().map(move |x| (x - m.1).powi(2))).sum();
    let known = (repeats >= MIN_REPEATS && within > 0.0).then_some(within);
    let mut found =
        Stability { runs, days: days.len(), run: known.map(|w| of_run(w, repeats)), day: None, trend: None };
    if days.len() >= MIN_DAYS {
        let means = Means { list: means };
        let dof = days.len() - LINE_COEFFICIENTS;
        found.day = known.and_then(|within| of_days(&states(&means, within, repeats, dof)));
        found.trend = trend(&means);
    }
    found
}

/// The standard deviation of a run from the square sum within days.
fn of_run(within: f64, dof: usize) -> Known {
    let tail = 0.5 * (1.0 - INTERVAL_COVERAGE);
    let at = |p: f64| {
        let quantile = ChiSquared::new(dof as f64).map_or(f64::NAN, |law| law.inverse_cdf(p));
        (within / quantile).sqrt()
    };
    Known { value: (within / dof as f64).sqrt(), low: at(1.0 - tail), high: at(tail) }
}

/// A state that the draws allow: variance of days, and what that is where their means scatter at least as their runs let expect.
struct State {
    of_day: f64,
    of_day_at_most: f64,
}

/// All states.
fn states(means: &Means, within: f64, repeats: usize, dof: usize) -> Vec<State> {
    let asked = draws(dof);
    let each = |of_run: f64, asked: f64| {
        let of_day = means.of_day(of_run, asked)?;
        let of_day_at_most = means.of_day(of_run, asked * means.share_of_expected(of_run, dof)?)?;
        Some(State { of_day, of_day_at_most })
    };
    let mut all = vec![];
    for of_run in draws(repeats).into_iter().map(|w| within / w) {
        all.extend(asked.iter().filter_map(|asked| each(of_run, *asked)));
    }
    all
}

/// A share of sorted values lies below this.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = (share * sorted.len() as f64 - 0.5).clamp(0.0, (sorted.len() - 1) as f64);
    let below = at.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (at - below as f64) * (sorted[above] - sorted[below])
}

fn of_days(states: &[State]) -> Option<DayScatter> {
    let mut deviations: Vec<f64> = states.iter().map(|s| s.of_day.sqrt()).collect();
    if deviations.is_empty() {
        return None;
    }
    deviations.sort_ascending();
    let absent = deviations.iter().filter(|d| **d <= 0.0).count() as f64 / deviations.len() as f64;
    if absent > MAX_ABSENT_PROBABILITY {
        // Means that scatter less than their runs let expect do so by chance, and exclude no more than others would.
        let mut bounds: Vec<f64> = states.iter().map(|s| s.of_day_at_most.sqrt()).collect();
        bounds.sort_ascending();
        return Some(DayScatter::AtMost(quantile(&bounds, INTERVAL_COVERAGE)));
    }
    let tail = 0.5 * (1.0 - INTERVAL_COVERAGE);
    let [low, value, high] = [tail, 0.5, 1.0 - tail].map(|p| quantile(&deviations, p));
    Some(DayScatter::Known(Known { value, low, high }))
}

/// The slope through the means of days, each with the same weight: Student's law whatever days and runs scatter by, where all days have
/// as many runs.
fn trend(means: &Means) -> Option<Known> {
    let equal = Means { list: means.list.iter().map(|(t, x, _)| (*t, *x, 1.0)).collect() };
    let line = equal.line(1.0, 0.0)?;
    let dof = means.list.len().checked_sub(LINE_COEFFICIENTS)? as f64;
    let standard = (line.about / dof * line.variance).sqrt();
    let half = student_quantile(0.5 + 0.5 * INTERVAL_COVERAGE, dof) * standard;
    Some(Known { value: line.slope, low: line.slope - half, high: line.slope + half })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn days(of: &[&[f64]]) -> Vec<Day> {
        of.iter().enumerate().map(|(i, runs)| Day { time: i as f64, runs: runs.to_vec() }).collect()
    }

    #[test]
    fn the_scatter_of_a_run_is_that_within_days() {
        // Two degrees of freedom are too few; a third day adds one to the square sum of 0.5 + 2.
        let two = days(&[&[1.0, 2.0], &[11.0, 13.0]]);
        assert_eq!(stability(&two).run, None);
        let three = days(&[&[1.0, 2.0], &[11.0, 13.0], &[5.0, 5.0], &[]]);
        let found = stability(&three);
        let run = found.run.unwrap();
        assert!((run.value - (2.5_f64 / 3.0).sqrt()).abs() < 1e-12);
        // χ² of 3 at 2.5 and 97.5 %: 0.21580, 9.34840.
        assert!(
            (run.low - (2.5_f64 / 9.3484).sqrt()).abs() < 1e-4
                && (run.high - (2.5_f64 / 0.2158).sqrt()).abs() < 1e-3
        );
        assert_eq!((found.runs, found.days, found.day, found.trend), (6, 3, None, None));
    }

    #[test]
    fn one_run_a_day_tells_the_trend_alone() {
        // Residuals ±1 about the slope 2: Σ(t − t̄)² = 5, s² = Σr²/2.
        let four = days(&[&[1.0], &[1.0], &[3.0], &[7.0]]);
        let found = stability(&four);
        assert_eq!((found.run, found.day), (None, None));
        let trend = found.trend.unwrap();
        // Slope 2, square sum about it 4: s² = 2, u = √(2/5), Student's quantile of 2 degrees of freedom 4.303.
        assert!((trend.value - 2.0).abs() < 1e-6, "{trend:?}");
        let half = 4.303 * (2.0_f64 / 5.0).sqrt();
        assert!((trend.high - 2.0 - half).abs() < 1e-3 && (2.0 - trend.low - half).abs() < 1e-3, "{trend:?}");
    }

    #[test]
    fn days_that_differ_as_their_runs_do_have_a_bound_alone() {
        let alike = days(&[&[0.0, 1.0], &[1.0, 0.1], &[0.2, 0.9], &[0.8, 0.3], &[0.4, 0.6]]);
        assert!(matches!(stability(&alike).day, Some(DayScatter::AtMost(most)) if most > 0.1 && most < 2.0));
        let apart = days(&[&[0.0, 0.1], &[9.0, 9.1], &[-5.0, -5.2], &[4.0, 4.1], &[1.0, 1.2]]);
        assert!(matches!(stability(&apart).day, Some(DayScatter::Known(k)) if k.low > 2.0 && k.high > 6.0));
        assert_eq!(stability(&[]), Stability { runs: 0, days: 0, run: None, day: None, trend: None });
    }

    /// Shares of simulated units of which the interval or bound holds: run, day, trend.
    fn held(of_day: f64, sizes: &[usize], units: usize, seed: u64) -> [f64; 3] {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut normal = || Distribution::<f64>::sample(&StandardNormal, &mut rng);
        let mut held = [0usize; 3];
        for _ in 0..units {
            let days: Vec<Day> = sizes
                .iter()
                .enumerate()
                .map(|(i, n)| {
                    // Days are not evenly apart.
                    let time = (i as f64 + 0.3 * (i % 3) as f64) / 30.0;
                    let level = 5.0 + 2.0 * time + of_day * normal();
                    Day { time, runs: (0..*n).map(|_| level + normal()).collect() }
                })
                .collect();
            let found = stability(&days);
            let run = found.run.unwrap();
            let day = match found.day.unwrap() {
                DayScatter::Known(k) => (k.low..=k.high).contains(&of_day),
                DayScatter::AtMost(most) => of_day <= most,
            };
            let trend = found.trend.unwrap();
            let holds = [(run.low..=run.high).contains(&1.0), day, (trend.low..=trend.high).contains(&2.0)];
            held.iter_mut().zip(holds).for_each(|(count, holds)| *count += usize::from(holds));
        }
        held.map(|count| count as f64 / units as f64)
    }

    #[test]
    fn intervals_hold_with_and_without_a_scatter_of_days() {
        for (seed, (of_day, sizes)) in [
            (0.0, &[2, 2, 2, 2, 2][..]),
            (0.4, &[3, 1, 2, 4, 1, 2, 3]),
            (1.0, &[2, 2, 2, 2]),
            (5.0, &[3, 1, 2, 4, 1, 2, 3]),
        ]
        .into_iter()
        .enumerate()
        {
            let found = held(of_day, sizes, 150, 71 + seed as u64);
            // 150 units at 95 %: fewer than 133 hold once in 1000 studies.
            assert!(found.iter().all(|share| *share >= 0.885), "{of_day}: {found:?}");
        }
    }

    #[test]
    #[ignore = "measures: cargo test --release -p sagnac-core --lib lot::stability -- --ignored --nocapture"]
    fn coverage_over_many_units() {
        for of_day in [0.0, 0.2, 0.5, 1.0, 3.0] {
            for sizes in [&[2, 2, 2, 2][..], &[3, 1, 2, 4, 1, 2, 3], &[2; 12], &[5; 6]] {
                println!("{of_day} {sizes:?} {:?}", held(of_day, sizes, 2000, 5));
            }
        }
    }
}
