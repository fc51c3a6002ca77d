//! What a test can decide before any data exist: the power of a limit for a record of given length.
//!
//! The evidence a record is expected to give stands in for the record (Cowan et al., Eur. Phys. J. C 71, 2011,
//! "Asimov data set"): the profile likelihood on it gives the mean of the normal score that real records scatter
//! about with variance 1.

use super::data::NoiseType;
use super::evidence::Evidence;
use super::identification::StandardThresholds;
use super::identification::claims::{LIMIT_RISE, MAX_IDENTIFIABLE_SIGMA, MIN_RIVAL_RATIO, rival_of};
use super::identification::linear_fit::{Likelihood, RAMP_INDEX, Structure, position, toggled};
use super::identification::profile::Profile;
use super::model::{NoiseModel, TERMS};
use crate::estimate::{chi_square_quantile, normal_probability, normal_quantile};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability that both decisions must reach before a record counts as long enough.
pub const MIN_POWER: f64 = 0.8;
/// Fewest samples that are analysed.
const MIN_SAMPLES: u64 = 64;
/// Longest record considered, h.
const MAX_HOURS: f64 = 1000.0;

/// What a test with an upper limit can decide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    /// Probability that a unit 1.5 times over the limit is failed.
    pub fail_probability_at_1_5: f64,
    /// Probability that a unit at half the limit is passed.
    pub pass_probability_at_half: f64,
    /// Upper limit that the record is expected to give for a unit without the term, unit of the term. `None` where
    /// no such limit exists.
    pub expected_upper_limit_at_zero: Option<f64>,
    /// Shortest record, h, with which both probabilities reach [`MIN_POWER`]; `None` when 1000 h do not suffice.
    pub needed_duration_h: Option<f64>,
}

impl Power {
    /// True when both decisions are likely enough.
    pub fn is_enough(&self) -> bool {
        self.fail_probability_at_1_5 >= MIN_POWER && self.pass_probability_at_half >= MIN_POWER
    }
}

/// Power of an upper `limit` on the coefficient of `term`, for a unit whose other terms are those of `background`.
///
/// `samples` samples of `tau0_s` s; `risk` is that of the guard band. `None` when the limit is not positive or the
/// record too short to be analysed.
pub fn decision_power(
    term: NoiseType,
    limit: f64,
    background: &NoiseModel,
    samples: u64,
    tau0_s: f64,
    risk: f64,
) -> Option<Power> {
    if limit.is_nan() || limit <= 0.0 || samples < MIN_SAMPLES || tau0_s.is_nan() || tau0_s <= 0.0 {
        return None;
    }
    let at = |samples: u64| {
        let fail = fail_probability(term, limit, background, samples, tau0_s, risk)?;
        let pass = pass_probability(term, limit, background, samples, tau0_s, risk)?;
        Some((fail, pass))
    };
    let (fail, pass) = at(samples)?;
    let enough = |hours: f64| {
        at((hours * 3600.0 / tau0_s) as u64).is_some_and(|(f, p)| f >= MIN_POWER && p >= MIN_POWER)
    };
    Some(Power {
        fail_probability_at_1_5: fail,
        pass_probability_at_half: pass,
        expected_upper_limit_at_zero: expected_upper_limit(term, background, samples, tau0_s),
        needed_duration_h: shortest(samples as f64 * tau0_s / 3600.0, enough),
    })
}

/// Relative variance that the estimate of the coefficient of `term` is predicted to have in a record of a unit with this `value` and the
/// other terms of `background`. `None` for a record too short to be analysed.
pub fn term_variance(
    term: NoiseType,
    value: f64,
    background: &NoiseModel,
    samples: u64,
    tau0_s: f64,
) -> Option<f64> {
    if samples < MIN_SAMPLES || tau0_s.is_nan() || tau0_s <= 0.0 {
        return None;
    }
    let case = Case::new(term, value, background, samples, tau0_s)?;
    let relative = case.relative_sigma(&case.structure);
    (relative.is_finite() && relative > 0.0).then_some(relative * relative)
}

/// Power of an upper limit on a standard deviation whose square is χ² with `edf(hours)` degrees of freedom.
pub fn deviation_power(edf: impl Fn(f64) -> f64, hours: f64, risk: f64) -> Power {
    let at = |hours: f64| {
        let dof = edf(hours).max(1e-3);
        let Ok(law) = ChiSquared::new(dof) else { return (0.0, 0.0) };
        // Over by 1.5: the lower bound s²·dof/χ²(1−risk) must exceed L². At half: the upper bound must not.
        let fail = law.sf(chi_square_quantile(1.0 - risk, dof) / 2.25);
        let pass = law.cdf(chi_square_quantile(risk, dof) * 4.0);
        (fail, pass)
    };
    over_hours(at, hours, None)
}

/// Power of a limit on the size of a bias whose standard uncertainty is `uncertainty(hours)`, same unit as the limit.
pub fn bias_power(limit: f64, uncertainty: impl Fn(f64) -> f64, hours: f64, risk: f64) -> Power {
    let guard = normal_quantile(1.0 - risk);
    let at = |hours: f64| {
        let u = uncertainty(hours).max(1e-300);
        let fail = normal_probability(0.5 * limit / u - guard);
        let pass = (fail - normal_probability(guard - 1.5 * limit / u)).max(0.0);
        (fail, pass)
    };
    over_hours(at, hours, Some(normal_quantile(0.975) * uncertainty(hours)))
}

/// Power where both probabilities, (failed, passed), are a function of the hours recorded.
fn over_hours(
    at: impl Fn(f64) -> (f64, f64),
    hours: f64,
    expected_upper_limit_at_zero: Option<f64>,
) -> Power {
    let (fail, pass) = at(hours);
    let enough = |h: f64| {
        let (f, p) = at(h);
        f >= MIN_POWER && p >= MIN_POWER
    };
    Power {
        fail_probability_at_1_5: fail,
        pass_probability_at_half: pass,
        expected_upper_limit_at_zero,
        needed_duration_h: shortest(hours, enough),
    }
}

/// Length of a record in which a slow term has a value over that in which its likelihood ratio alone says so. The choice among sets of
/// slow terms and Markov processes costs more than the price of the term; for a random walk, of which few modes show, most. Set
/// by simulation, validated in the study of record lengths.
fn length_of_choice(term: NoiseType) -> f64 {
    match term {
        NoiseType::Flicker => 1.35,
        NoiseType::RateRandomWalk => 2.5,
        _ => 1.0,
    }
}

/// Shortest record, h, of a unit with this `value` of `term` beside the other terms of `background`, in which the term is
/// given a value with probability [`MIN_POWER`], by samples of `tau0_s` s; `None` when 1000 h do not suffice or the value is not
/// positive.
pub fn resolving_duration(term: NoiseType, value: f64, background: &NoiseModel, tau0_s: f64) -> Option<f64> {
    if value.is_nan() || value <= 0.0 || tau0_s.is_nan() || tau0_s <= 0.0 {
        return None;
    }
    let claimed = |hours: f64| {
        let samples = (hours * 3600.0 / tau0_s) as u64;
        let pair =
            (samples >= MIN_SAMPLES).then(|| Pair::new(term, value, background, samples, tau0_s))??;
        Some(1.0 - normal_probability(pair.claim_needs()?))
    };
    let hours = shortest(1.0, |hours| claimed(hours).is_some_and(|p| p >= MIN_POWER))?;
    Some(hours * length_of_choice(term)).filter(|hours| *hours <= MAX_HOURS)
}

/// Shortest duration, h, that is enough: halving and doubling from a start, then bisection to 5 %.
fn shortest(start_h: f64, enough: impl Fn(f64) -> bool) -> Option<f64> {
    let (mut low, mut high) = (0.0, start_h.clamp(1e-3, MAX_HOURS));
    if enough(high) {
        for _ in 0..12 {
            if !enough(0.5 * high) {
                low = 0.5 * high;
                break;
            }
            high *= 0.5;
        }
    } else {
        loop {
            if high >= MAX_HOURS {
                return None;
            }
            low = high;
            high = (2.0 * high).min(MAX_HOURS);
            if enough(high) {
                break;
            }
        }
    }
    while high - low > 0.05 * high {
        let middle = 0.5 * (low + high);
        if enough(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// A normal score as it scatters over records: mean and standard deviation.
#[derive(Debug, Clone, Copy)]
struct Score {
    mean: f64,
    sd: f64,
}

impl Score {
    /// The standard normal value beyond which a record's score exceeds `needed`.
    fn needs(self, needed: f64) -> f64 {
        (needed - self.mean) / self.sd
    }
}

struct Case {
    likelihood: Likelihood,
    model: NoiseModel,
    /// The terms the unit has.
    structure: Structure,
    term: usize,
}

impl Case {
    fn new(term: NoiseType, value: f64, background: &NoiseModel, samples: u64, tau0_s: f64) -> Option<Case> {
        let model = background.with(term, value);
        let likelihood = Likelihood::new(&Evidence::expected(&model, samples, tau0_s))?;
        let structure = TERMS.map(|t| model.coefficient(t) != 0.0);
        Some(Case { likelihood, model, structure, term: position(term) })
    }

    fn deviance(&self, structure: &Structure, fixed: Option<(usize, f64)>) -> Option<f64> {
        Some(self.likelihood.maximise(structure, fixed, None)?.deviance)
    }

    /// Root of the rise of the deviance at `value` over its minimum.
    fn score(&self, structure: &Structure, value: f64) -> Option<f64> {
        let held = self.deviance(structure, Some((self.term, value)))?;
        let top = if self.term == RAMP_INDEX {
            // At a held ramp the likelihood is the plain one, also at the maximum.
            let best = self.likelihood.maximise(structure, None, None)?;
            self.deviance(structure, Some((RAMP_INDEX, best.ramp)))?
        } else {
            self.deviance(structure, None)?
        };
        Some((held - top).max(0.0).sqrt())
    }

    /// Terms left free when the term is tested: the ramp is one for rate random walk, and where the unit has one.
    fn claim_structure(&self) -> Structure {
        let mut all = [true; 5];
        all[RAMP_INDEX] = self.structure[RAMP_INDEX]
            || self.term == RAMP_INDEX
            || self.term == position(NoiseType::RateRandomWalk);
        all
    }

    /// Root of the likelihood ratio by which the term is claimed.
    fn claim_score(&self) -> Option<f64> {
        let all = self.claim_structure();
        if self.term == RAMP_INDEX {
            return self.score(&all, 0.0);
        }
        let without = self.deviance(&toggled(&all, self.term, false), None)?;
        Some((without - self.deviance(&all, None)?).max(0.0).sqrt())
    }

    /// Standard deviation of the term without its rival over that with the rival free; `None` without a rival that the
    /// unit lacks.
    fn rival_ratio(&self) -> Option<f64> {
        let rival = rival_of(self.term).filter(|r| !self.structure[*r])?;
        let free = self.relative_sigma(&toggled(&self.structure, rival, true));
        let ratio = self.relative_sigma(&self.structure) / free;
        (ratio.is_finite() && ratio > 0.0).then_some(ratio.min(1.0))
    }

    /// Relative standard deviation of the estimated coefficient within a structure.
    fn relative_sigma(&self, structure: &Structure) -> f64 {
        let bound =
            self.likelihood.variance_bound(&self.model, structure)[self.term][self.term].max(0.0).sqrt();
        let value = self.model.coefficient(TERMS[self.term]).abs();
        if self.term == RAMP_INDEX { bound / value } else { bound / (2.0 * value * value) }
    }
}

/// A unit at some size of the term, and the same a little larger: how scores move with the size tells how they
/// scatter.
struct Pair {
    here: Case,
    above: Case,
}

/// Relative step from one to the other.
const RELATIVE_STEP: f64 = 0.03;

impl Pair {
    fn new(term: NoiseType, value: f64, background: &NoiseModel, samples: u64, tau0_s: f64) -> Option<Pair> {
        let case = |v| Case::new(term, v, background, samples, tau0_s);
        Some(Pair { here: case(value)?, above: case(value * (1.0 + RELATIVE_STEP))? })
    }

    fn scatter(&self, of: impl Fn(&Case) -> Option<f64>) -> Option<Score> {
        let (mean, above) = (of(&self.here)?, of(&self.above)?);
        let slope = (above - mean) / RELATIVE_STEP;
        // Beyond its own size a term is not seen at all, and the laws below, made for small scatter, would run away.
        let sigma = self.here.relative_sigma(&self.here.structure).min(1.0);
        // The square of the coefficient is estimated like a χ², whose median lies below its mean.
        let shift = if self.here.term == RAMP_INDEX { 0.0 } else { 2.0 / 3.0 * sigma * sigma };
        Some(Score { mean: mean - shift * slope, sd: (slope.abs() * sigma).clamp(0.3, 3.0) })
    }

    /// Correlation of the fluctuation that claims the term with the one that sizes it: the claim leaves more terms
    /// free and so sees less. Terms at their boundary are free half of the time.
    fn correlation(&self) -> f64 {
        let sized = self.here.relative_sigma(&self.here.structure).powi(2);
        let claimed = self.here.relative_sigma(&self.here.claim_structure()).powi(2);
        (sized / (0.5 * (sized + claimed))).sqrt().clamp(0.0, 0.999)
    }

    /// From where on a term that shows as much is claimed. One that is hardly identifiable has to be preferred clearly;
    /// the larger a record shows it, the better it is known, about as the root of its size.
    fn claim_needs(&self) -> Option<f64> {
        let term = *TERMS.get(self.here.term)?;
        let relative = self.here.relative_sigma(&self.here.structure);
        let scatter = self.scatter(Case::claim_score)?;
        let needs = |relative: f64| scatter.needs(StandardThresholds::default().of(term, relative).sqrt());
        let (known, hardly) = (needs(0.0), needs(f64::INFINITY));
        let turning = ((relative / MAX_IDENTIFIABLE_SIGMA).powi(2) - 1.0) / relative;
        Some(turning.min(hardly.max(known)).max(known.min(hardly)))
    }
}

/// ∫ φ(u) f(u) du over the standard normal.
fn normal_mean(f: impl Fn(f64) -> f64) -> f64 {
    const QUADRATURE_STEPS: i32 = 800;
    let width = 16.0 / f64::from(QUADRATURE_STEPS);
    (0..QUADRATURE_STEPS)
        .map(|i| {
            let u = -8.0 + (f64::from(i) + 0.5) * width;
            (-0.5 * u * u).exp() / (2.0 * std::f64::consts::PI).sqrt() * f(u) * width
        })
        .sum()
}

fn fail_probability(
    term: NoiseType,
    limit: f64,
    background: &NoiseModel,
    samples: u64,
    tau0_s: f64,
    risk: f64,
) -> Option<f64> {
    let pair = Pair::new(term, 1.5 * limit, background, samples, tau0_s)?;
    let guard = normal_quantile(1.0 - risk);
    let score = pair.scatter(|c| c.score(&c.structure, limit))?;
    let (claim, rho) = (pair.claim_needs()?, pair.correlation());
    let rest = (1.0 - rho * rho).sqrt();
    // Only a claimed term can be failed.
    let failed = |beyond: f64| {
        normal_mean(|u| if u > claim { normal_probability((rho * u - beyond) / rest) } else { 0.0 })
    };
    let Some(r) = pair.here.rival_ratio() else { return Some(failed(score.needs(guard))) };
    // A rival that is not claimed widens the interval where chance makes it gain so much: it then takes a part of the
    // term, whose estimate lies lower by its share of the mean of what is beyond that gain.
    let bound = MIN_RIVAL_RATIO.sqrt();
    let beyond = 1.0 - normal_probability(bound);
    let density = (-0.5 * MIN_RIVAL_RATIO).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let taken = density / beyond * (1.0 - r * r).sqrt();
    Some((1.0 - beyond) * failed(score.needs(guard)) + beyond * failed(score.needs((guard + taken) / r)))
}

fn pass_probability(
    term: NoiseType,
    limit: f64,
    background: &NoiseModel,
    samples: u64,
    tau0_s: f64,
    risk: f64,
) -> Option<f64> {
    let pair = Pair::new(term, 0.5 * limit, background, samples, tau0_s)?;
    // Scores of the limit seen from below: a larger fluctuation brings the unit closer to it.
    let below = -pair.scatter(|c| c.score(&c.structure, limit))?.needs(normal_quantile(1.0 - risk));
    let limited = -pair
        .scatter(|c| {
            let mut nuisance = [true; 5];
            nuisance[RAMP_INDEX] = c.structure[RAMP_INDEX] || c.term == RAMP_INDEX;
            c.score(&nuisance, limit)
        })?
        .needs(LIMIT_RISE.sqrt());
    let (claim, rho) = (pair.claim_needs()?, pair.correlation());
    let rest = (1.0 - rho * rho).sqrt();
    Some(normal_mean(|u| {
        let bound = if u > claim { below } else { limited };
        normal_probability((bound - rho * u) / rest)
    }))
}

/// The upper limit on a term that a record of a unit without it is expected to give.
pub fn expected_upper_limit(
    term: NoiseType,
    background: &NoiseModel,
    samples: u64,
    tau0_s: f64,
) -> Option<f64> {
    let case = Case::new(term, 0.0, background, samples, tau0_s)?;
    // Other terms that the unit lacks sit at zero in the expected evidence and may as well be left out.
    let structure = toggled(&case.structure, case.term, true);
    Profile::new(&case.likelihood, &structure, case.term)?.upper_limit(LIMIT_RISE)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_record_too_short_for_a_limit_passes_nothing() {
        let background = NoiseModel { n: 0.002, b: 0.003, ..Default::default() };
        for hours in [0.5, 1.0, 2.0, 10.0] {
            let samples = (hours * 3600.0) as u64;
            let p =
                decision_power(NoiseType::RateRandomWalk, 0.004, &background, samples, 1.0, 0.05).unwrap();
            let limit = p.expected_upper_limit_at_zero.unwrap();
            assert!(limit > 0.004 && p.pass_probability_at_half < 0.3, "{hours} h: {p:?}");
        }
    }

    use super::*;

    #[test]
    fn angle_random_walk_is_decided_by_ten_hours() {
        let background = NoiseModel { n: 0.0023, ..Default::default() };
        let power =
            decision_power(NoiseType::AngleRandomWalk, 0.003, &background, 36_000, 1.0, 0.05).unwrap();
        assert!(power.fail_probability_at_1_5 > 0.999 && power.pass_probability_at_half > 0.999);
        assert!(power.needed_duration_h.unwrap() < 1.0);
    }

    #[test]
    fn ten_hours_cannot_decide_a_small_flicker_limit() {
        let background = NoiseModel { n: 0.0023, ..Default::default() };
        let power = decision_power(NoiseType::Flicker, 0.001, &background, 36_000, 1.0, 0.05).unwrap();
        assert!(!power.is_enough());
        assert!(power.fail_probability_at_1_5 < 0.2, "{power:?}");
        assert!(power.needed_duration_h.is_none_or(|h| h > 100.0), "{power:?}");
        assert!(power.expected_upper_limit_at_zero.unwrap() > 0.001);
    }

    #[test]
    fn deviation_and_bias_powers_follow_their_laws() {
        // A unit far over a limit measured well is failed, and the powers grow with the length.
        let edf = |h: f64| 36.0 * h - 1.0;
        let (short, long) = (deviation_power(edf, 0.5, 0.05), deviation_power(edf, 10.0, 0.05));
        assert!(short.fail_probability_at_1_5 < long.fail_probability_at_1_5);
        assert!(long.is_enough() && long.needed_duration_h.unwrap() < 10.0);
        let bias = bias_power(0.01, |h| 0.004 / h.sqrt(), 1.0, 0.05);
        assert!((bias.fail_probability_at_1_5 - normal_probability(1.25 - 1.644854)).abs() < 1e-6);
        let needed = bias.needed_duration_h.unwrap();
        assert!((needed / (0.004 * (1.644854 + 0.841621) / 0.005_f64).powi(2) - 1.0).abs() < 0.06);
    }

    #[test]
    fn the_needed_duration_is_enough_and_nine_tenths_of_it_are_not() {
        // At other intervals than a second, so that hours and samples differ.
        let background = NoiseModel { n: 0.0023, ..Default::default() };
        for tau0_s in [0.5, 4.0] {
            let at = |hours: f64| {
                let samples = (hours * 3600.0 / tau0_s) as u64;
                decision_power(NoiseType::AngleRandomWalk, 0.003, &background, samples, tau0_s, 0.05).unwrap()
            };
            let needed = at(1.0).needed_duration_h.unwrap();
            assert!(at(needed).is_enough() && !at(0.9 * needed).is_enough(), "{tau0_s}: {needed} h");
        }
        let none = |limit, samples, tau0_s| {
            decision_power(NoiseType::AngleRandomWalk, limit, &background, samples, tau0_s, 0.05).is_none()
        };
        assert!(
            none(0.0, 3600, 1.0) && none(0.003, 63, 1.0) && none(0.003, 3600, 0.0) && !none(0.003, 64, 1.0)
        );
    }

    #[test]
    fn a_smaller_term_takes_longer_to_resolve() {
        let background = NoiseModel { n: 0.002, ..Default::default() };
        for term in [NoiseType::Flicker, NoiseType::RateRandomWalk] {
            let hours = |value: f64| resolving_duration(term, value, &background, 1.0);
            let [small, large] = [0.006, 0.012].map(|value| hours(value).unwrap());
            assert!(large > 0.1 && small > 1.5 * large && small < 100.0, "{term:?}: {small} {large}");
            // A thousandth of it needs more than the longest record considered.
            assert_eq!((hours(1e-6), hours(0.0), hours(f64::NAN)), (None, None, None));
        }
        assert_eq!(resolving_duration(NoiseType::Flicker, 0.006, &background, 0.0), None);
    }
}
