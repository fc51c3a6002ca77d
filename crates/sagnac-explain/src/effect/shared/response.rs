//! A flexible response to the history of a recorded column: any smooth curve of its value, its rate of change, delays of
//! several time constants, play of several widths. It decides *that* a column drives the rate and how much it explains,
//! before anything is said of the law.
//!
//! The terms are chosen one by one by what they gain under the noise at hand, each for a price, so that a response of one law
//! stays as cheap as that law.

use super::first_order::{decay, delayed};
use super::polynomial::Scale;
use super::pursuit::{choices, matching_pursuit, remove, unit};
use crate::effect::{
    Drivers, Regressors, ResponseLaw, SearchContext, StatePrior, Unmodelled, Values, list, number,
};
use crate::numeric::cosine::dct2;
use crate::numeric::special;

/// Highest order of the curve.
const MAX_CURVE_ORDER: usize = 10;
/// Time constants of the delays, s: from what a housing does in a minute to what a day does.
const DELAYS_S: [f64; 8] = [60.0, 150.0, 375.0, 940.0, 2350.0, 5900.0, 14_700.0, 36_700.0];
/// Widths of the play, in halves of the column's range.
pub(in crate::effect) const PLAY_WIDTHS: [f64; 4] = [0.03, 0.08, 0.2, 0.5];
/// Terms in all.
pub(in crate::effect) const TERM_COUNT: usize = MAX_CURVE_ORDER + 1 + DELAYS_S.len() + PLAY_WIDTHS.len();
/// Terms that a response has at most.
const MAX_TERMS: usize = 8;
/// Gain of log-likelihood that each term must bring: half the logarithm of some sixty modes that tell of a slow course, and
/// what the best of several terms gains by chance.
const TERM_PRICE: f64 = 4.0;

/// Name of the list of terms in a claim.
pub(in crate::effect) const TERMS_LIST: &str = "terms";
/// Name of the list of their time constants, s, or widths of play; 0 for a term that has none.
pub(in crate::effect) const SCALES_LIST: &str = "scales";
/// Name of the list of their coefficients, deg/h.
pub(in crate::effect) const COEFFICIENTS_LIST: &str = "coefficients_deg_h";
/// Name of the middle of the column's range.
pub(in crate::effect) const CENTER_NAME: &str = "center";
/// Name of half of the column's range.
pub(in crate::effect) const HALF_RANGE: &str = "half_range";

/// Uncertainty of the size of a course whose law has many parameters, beyond that of the fit: curves, loops and responses of several terms
/// leave out what does not pay for a term, and real ones have other shapes. From loops and curves of other formulas.
pub(in crate::effect) const ANY_SHAPE: Unmodelled = Unmodelled { first_parameter: 0.08, rms: 0.08 };

/// One term of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::effect) enum Term {
    /// Legendre polynomial of the scaled column.
    Curve { order: usize },
    /// Rate of change of the scaled column, per hour.
    Rate,
    /// The scaled column behind a first-order delay, less the column itself.
    Delay { time_constant_s: f64 },
    /// State of a play operator, −1/2 on a falling to 1/2 on a rising branch.
    Play { width: f64 },
}

impl Term {
    /// True where the term distinguishes the law from the others.
    fn is_of(&self, law: ResponseLaw) -> bool {
        match (law, self) {
            (ResponseLaw::Linear, Term::Curve { order }) => *order == 1,
            (ResponseLaw::Curve, Term::Curve { order }) => *order > 1,
            (ResponseLaw::Rate, Term::Rate | Term::Delay { .. })
            | (ResponseLaw::Lag, Term::Delay { .. })
            | (ResponseLaw::Hysteresis, Term::Play { .. }) => true,
            _ => false,
        }
    }

    /// The terms of the dictionary.
    fn all() -> impl Iterator<Item = Term> {
        let curves = (1..=MAX_CURVE_ORDER).map(|order| Term::Curve { order });
        let delays = DELAYS_S.into_iter().map(|time_constant_s| Term::Delay { time_constant_s });
        curves
            .chain([Term::Rate])
            .chain(delays)
            .chain(PLAY_WIDTHS.into_iter().map(|width| Term::Play { width }))
    }

    /// True where a record resolves it: a delay is longer than a sample and shorter than the record.
    fn resolved(self, drivers: &Drivers) -> bool {
        match self {
            Term::Delay { time_constant_s } => {
                (drivers.dt_s..=0.5 * drivers.length_s()).contains(&time_constant_s)
            }
            _ => true,
        }
    }

    /// Numbers by which a claim states it: that of its law, with a time constant or a width.
    fn stated(self) -> (f64, f64) {
        match self {
            Term::Curve { order } => (order as f64, 0.0),
            Term::Rate => (11.0, 0.0),
            Term::Delay { time_constant_s } => (12.0, time_constant_s),
            Term::Play { width } => (13.0, width),
        }
    }

    fn of_stated(term: f64, scale: f64) -> Option<Term> {
        match term.round() as i64 {
            order @ 1..=10 => Some(Term::Curve { order: order as usize }),
            11 => Some(Term::Rate),
            12 if scale > 0.0 => Some(Term::Delay { time_constant_s: scale }),
            13 if scale > 0.0 => Some(Term::Play { width: scale }),
            _ => None,
        }
    }

    /// Its course for a coefficient of 1; `scaled` is the column in units of its range.
    fn course(self, scaled: &[f64], drivers: &Drivers) -> Vec<f64> {
        match self {
            Term::Curve { order } => scaled.iter().map(|x| legendre(order, *x)).collect(),
            Term::Rate => rate_per_hour(scaled, drivers.dt_s),
            Term::Delay { time_constant_s } => {
                let late = delayed(scaled, time_constant_s, drivers.dt_s);
                late.iter().zip(scaled).map(|(d, x)| d - x).collect()
            }
            Term::Play { width } => play(scaled, width),
        }
    }

    /// Prior of that state, for the term of some position.
    fn state(self, position: usize) -> Option<StatePrior> {
        let delays = matches!(self, Term::Delay { .. });
        delays.then_some(StatePrior { column: Some(position), deviation: SCALED_RANGE })
    }

    /// Course of its unknown state at the beginning of the record.
    fn initial(self, drivers: &Drivers) -> Option<Vec<f64>> {
        match self {
            Term::Delay { time_constant_s } => Some(decay(time_constant_s, drivers)),
            _ => None,
        }
    }
}

/// Range of a column in the unit of terms.
const SCALED_RANGE: f64 = 2.0;

/// A response that was found.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::effect) struct ResponseFound {
    /// One bit a term.
    pub mask: u32,
    /// The law that alone explains most.
    pub law: ResponseLaw,
    /// Gain of log-likelihood.
    pub gain: f64,
    /// Choices of as many terms.
    pub trials: f64,
}

impl ResponseFound {
    /// Gain less the price of its terms.
    pub fn worth(&self) -> f64 {
        self.gain - TERM_PRICE * f64::from(self.mask.count_ones())
    }
}

/// A dictionary of terms in whitened modes.
struct Dictionary {
    terms: Vec<Term>,
    modes: Vec<Vec<f64>>,
    residual: Vec<f64>,
}

impl Dictionary {
    fn new(values: &[f64], drivers: &Drivers, context: &SearchContext<'_>) -> Dictionary {
        let roots: Vec<f64> = context.powers.iter().map(|p| 1.0 / p.sqrt()).collect();
        let whitened = |modes: &[f64]| -> Vec<f64> {
            modes.iter().zip(&roots).skip(1).map(|(x, r)| if r.is_finite() { x * r } else { 0.0 }).collect()
        };
        let scaled = scaled(values, Scale::of(values));
        let terms: Vec<Term> = Term::all().collect();
        let one = |term: &Term| {
            if !term.resolved(drivers) {
                return vec![];
            }
            let mut modes = whitened(&dct2(&term.course(&scaled, drivers)));
            if let Some(initial) = term.initial(drivers) {
                remove(&mut modes, &unit(whitened(&dct2(&initial))));
            }
            modes
        };
        let modes = terms.iter().map(one).collect();
        Dictionary { terms, modes, residual: whitened(context.modes) }
    }

    /// Chooses terms among those allowed, one by one; each must gain the price.
    fn matching_pursuit(&self, allowed: impl Fn(&Term) -> bool, most: usize) -> (u32, f64) {
        let chosen =
            matching_pursuit(&self.modes, |i| allowed(&self.terms[i]), &self.residual, most, TERM_PRICE);
        (chosen.terms.iter().fold(0, |mask, i| mask | 1 << i), chosen.gain)
    }
}

/// The response to a column that gains most for its price; `None` where no term pays for itself.
pub(in crate::effect) fn search(
    values: &[f64],
    drivers: &Drivers,
    context: &SearchContext<'_>,
) -> Option<ResponseFound> {
    let dictionary = Dictionary::new(values, drivers, context);
    let (mask, gain) = dictionary.matching_pursuit(|_| true, MAX_TERMS);
    if mask == 0 {
        return None;
    }
    let trials = choices(TERM_COUNT, mask.count_ones() as usize);
    Some(ResponseFound { mask, law: leading_law(&dictionary), gain, trials })
}

/// The law that alone explains most for its price.
fn leading_law(dictionary: &Dictionary) -> ResponseLaw {
    let worth = |law: ResponseLaw| {
        let allowed = |t: &Term| match (law, t) {
            (ResponseLaw::Linear, Term::Curve { order }) => *order == 1,
            (ResponseLaw::Curve, Term::Curve { .. }) => true,
            // The delayed column less the column is the rate of the delayed one.
            (ResponseLaw::Rate, Term::Rate | Term::Delay { .. }) => true,
            // A delayed column is the column and what the delay changes of it; a loop has a slope.
            (ResponseLaw::Lag, Term::Delay { .. }) => true,
            (ResponseLaw::Lag | ResponseLaw::Hysteresis, Term::Curve { order }) => *order == 1,
            (ResponseLaw::Hysteresis, Term::Play { .. }) => true,
            _ => false,
        };
        let most = match law {
            ResponseLaw::Linear | ResponseLaw::Rate => 1,
            ResponseLaw::Lag => 2,
            ResponseLaw::Hysteresis => 3,
            ResponseLaw::Curve => MAX_CURVE_ORDER,
        };
        let (mask, gain) = dictionary.matching_pursuit(allowed, most);
        let own = |(i, t): (usize, &Term)| mask & (1 << i) != 0 && t.is_of(law);
        let is_law = dictionary.terms.iter().enumerate().any(own);
        if is_law { gain - TERM_PRICE * f64::from(mask.count_ones()) } else { 0.0 }
    };
    // Laws in the order of their simplicity: a later one must have a score higher by the price of a term.
    let mut best = (ResponseLaw::Linear, worth(ResponseLaw::Linear));
    for law in ResponseLaw::ALL.into_iter().skip(1) {
        let worth = worth(law);
        if worth > best.1 + TERM_PRICE {
            best = (law, worth);
        }
    }
    best.0
}

/// The response of one term, the curve of first order.
pub(in crate::effect) const FIRST_ORDER: u32 = 1;

/// Factor that makes the first coefficient of a response that of a linear law, of a rate, per hour, or of a lag in its static state, of
/// the scaled column; `None` for a response of another form.
pub(in crate::effect) fn per_unit(mask: u32, law: ResponseLaw) -> Option<f64> {
    match (law, &terms(mask)[..]) {
        (ResponseLaw::Linear, [Term::Curve { order: 1 }]) | (ResponseLaw::Rate, [Term::Rate]) => Some(1.0),
        // The delayed column trails behind by the time constant times its rate.
        (ResponseLaw::Rate, [Term::Delay { time_constant_s }]) => Some(-time_constant_s / 3600.0),
        // At rest no delay is behind.
        (ResponseLaw::Lag, [Term::Curve { order: 1 }, rest @ ..])
            if rest.iter().all(|t| matches!(t, Term::Delay { .. })) =>
        {
            Some(1.0)
        }
        _ => None,
    }
}

/// Uncertainty of the coefficient and the rms of a response, beyond that of its fit. A coefficient of a rate behind a delay moves with the
/// delay, which is known to a step of its grid only.
pub(in crate::effect) fn unmodelled(
    mask: u32,
    law: ResponseLaw,
    values: &[f64],
    drivers: &Drivers,
) -> Unmodelled {
    /// Step in the logarithm of a delay over which its influence is measured.
    const LOG_DELAY_STEP: f64 = 0.2;
    let of_rms = Unmodelled { first_parameter: 0.0, ..ANY_SHAPE };
    let [term] = terms(mask)[..] else { return of_rms };
    match (law, term) {
        (ResponseLaw::Rate, Term::Delay { time_constant_s }) => {
            let scaled = scaled(values, Scale::of(values));
            let rate = |time_constant_s: f64| {
                let course = Term::Delay { time_constant_s }.course(&scaled, drivers);
                course.into_iter().map(|x| x / time_constant_s).collect::<Vec<f64>>()
            };
            let (here, beside) = (rate(time_constant_s), rate(time_constant_s * LOG_DELAY_STEP.exp()));
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let slope = (dot(&here, &beside) / dot(&beside, &beside)).ln() / LOG_DELAY_STEP;
            // Anywhere within a step of the grid as likely.
            let step = (DELAYS_S[1] / DELAYS_S[0]).ln() / 12f64.sqrt();
            Unmodelled { first_parameter: slope.abs() * step, rms: 0.0 }
        }
        (ResponseLaw::Linear | ResponseLaw::Rate, _) => Unmodelled::default(),
        _ => of_rms,
    }
}

/// The columns of a response.
pub(in crate::effect) fn regressors(mask: u32, values: &[f64], drivers: &Drivers) -> Regressors {
    let scaled = scaled(values, Scale::of(values));
    let terms = terms(mask);
    Regressors {
        offset: None,
        columns: terms.iter().map(|t| t.course(&scaled, drivers)).collect(),
        nuisance: terms.iter().filter_map(|t| t.initial(drivers)).collect(),
        states: terms.iter().enumerate().filter_map(|(i, t)| t.state(i)).collect(),
    }
}

/// Lists by which a claim states a response.
pub(in crate::effect) fn stated_lists(mask: u32, coefficients: &[f64]) -> Vec<(&'static str, Vec<f64>)> {
    let (terms, scales) = terms(mask).into_iter().map(Term::stated).unzip();
    vec![(TERMS_LIST, terms), (SCALES_LIST, scales), (COEFFICIENTS_LIST, coefficients.to_vec())]
}

/// Middle and half of the range of a column, as a claim states them.
pub(in crate::effect) fn stated_range(values: &[f64]) -> [f64; 2] {
    let Scale { center, half } = Scale::of(values);
    [center, half]
}

/// The course of a claimed response, deg/h; `None` where something is missing or lists differ in length.
pub(in crate::effect) fn course(stated: &Values, values: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
    let scale = Scale { center: number(stated, CENTER_NAME)?, half: number(stated, HALF_RANGE)? };
    let terms = stated_terms(stated)?;
    let coefficients = list(stated, COEFFICIENTS_LIST);
    if scale.half.is_nan() || scale.half <= 0.0 || terms.len() != coefficients.len() {
        return None;
    }
    let scaled = scaled(values, scale);
    let mut out = vec![0.0; values.len()];
    for (term, coefficient) in terms.iter().zip(coefficients) {
        out.iter_mut().zip(term.course(&scaled, drivers)).for_each(|(o, x)| *o += coefficient * x);
    }
    Some(out)
}

/// Courses of the unknown states of a claimed response at the beginning of the record.
pub(in crate::effect) fn initial_states(stated: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
    stated_terms(stated).unwrap_or_default().iter().filter_map(|t| t.initial(drivers)).collect()
}

fn stated_terms(stated: &Values) -> Option<Vec<Term>> {
    let (terms, scales) = (list(stated, TERMS_LIST), list(stated, SCALES_LIST));
    if terms.is_empty() || terms.len() != scales.len() {
        return None;
    }
    terms.iter().zip(scales).map(|(t, s)| Term::of_stated(*t, *s)).collect()
}

fn terms(mask: u32) -> Vec<Term> {
    Term::all().enumerate().filter(|(i, _)| mask & (1 << i) != 0).map(|(_, term)| term).collect()
}

fn scaled(values: &[f64], scale: Scale) -> Vec<f64> {
    values.iter().map(|v| scale.scaled(*v)).collect()
}

/// Rate of change per hour; differences over two samples, over one at the ends.
pub(super) fn rate_per_hour(scaled: &[f64], dt_s: f64) -> Vec<f64> {
    let n = scaled.len();
    let at = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
        (scaled[b] - scaled[a]) / ((b - a).max(1) as f64 * dt_s) * 3600.0
    };
    (0..n).map(at).collect()
}

/// State of a play operator that begins in its middle.
pub(in crate::effect) fn play(scaled: &[f64], width: f64) -> Vec<f64> {
    let mut at = scaled.first().copied().unwrap_or(0.0);
    let follow = |x: &f64| {
        at = at.max(x - width).min(x + width);
        0.5 * (x - at) / width
    };
    scaled.iter().map(follow).collect()
}

/// Legendre polynomial; beyond the range, where it would grow without bound, the line through its end.
fn legendre(order: usize, x: f64) -> f64 {
    let inside = x.clamp(-1.0, 1.0);
    // The slope at the ends is ± order (order + 1) / 2.
    let slope = 0.5 * (order * (order + 1)) as f64;
    let sign = if inside < 0.0 && order.is_multiple_of(2) { -1.0 } else { 1.0 };
    special::legendre(order, inside) + sign * slope * (x - inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    fn drivers(samples: usize) -> Drivers {
        Drivers { dt_s: 10.0, samples, averaged: 1, ..Drivers::default() }
    }

    fn swing(samples: usize) -> Vec<f64> {
        (0..samples).map(|i| 20.0 + 8.0 * (i as f64 / 150.0).sin() + 0.002 * i as f64).collect()
    }

    /// A draw of white noise of deviation 1 with what `added` says.
    fn found(added: &[f64], values: &[f64]) -> Option<ResponseFound> {
        let mut state = 7u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let noise: Vec<f64> = (0..values.len()).map(|_| (0..12).map(|_| uniform()).sum()).collect();
        let residual: Vec<f64> = noise.iter().zip(added).map(|(n, a)| n + a).collect();
        let modes = dct2(&residual);
        let mut powers = vec![1.0; values.len()];
        powers[0] = f64::INFINITY;
        let context = SearchContext { score: &residual, modes: &modes, powers: &powers };
        search(values, &drivers(values.len()), &context)
    }

    #[test]
    fn each_law_is_found_by_its_own_shape() {
        let values = swing(2000);
        let n = values.len();
        let x = scaled(&values, Scale::of(&values));
        let made = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<f64>>();
        // A kink is no polynomial; two layers are no single delay.
        let kink = made(&|i| 2.0 * (x[i] - 0.3).max(0.0));
        assert_eq!(found(&kink, &values).unwrap().law, ResponseLaw::Curve);
        let rate = rate_per_hour(&x, 10.0);
        assert_eq!(found(&made(&|i| 0.4 * rate[i]), &values).unwrap().law, ResponseLaw::Rate);
        assert_eq!(found(&made(&|i| 0.5 * x[i]), &values).unwrap().law, ResponseLaw::Linear);
        let state = play(&x, 0.15);
        assert_eq!(found(&made(&|i| 1.2 * state[i]), &values).unwrap().law, ResponseLaw::Hysteresis);
        assert!(found(&vec![0.0; n], &values).is_none(), "noise follows nothing");
    }

    #[test]
    fn a_rate_behind_a_delay_is_known_to_a_step_of_the_delay_where_the_column_is_faster_than_it() {
        // A period of 600 s: far slower than 60 s and far faster than 36 700 s.
        let values: Vec<f64> =
            (0..20_000).map(|i| (f64::from(i) * std::f64::consts::TAU / 60.0).sin()).collect();
        let drivers = drivers(values.len());
        let of = |delay: usize, law| unmodelled(1 << (MAX_CURVE_ORDER + 1 + delay), law, &values, &drivers);
        let step = 2.5f64.ln() / 12f64.sqrt();
        let [slow, fast] = [0, DELAYS_S.len() - 1].map(|d| of(d, ResponseLaw::Rate).first_parameter / step);
        assert!(slow < 0.4 && (fast - 1.0).abs() < 0.02, "{slow} {fast}");
        assert_eq!(of(0, ResponseLaw::Lag), Unmodelled { first_parameter: 0.0, rms: 0.08 });
        assert_eq!(unmodelled(1, ResponseLaw::Linear, &values, &drivers), Unmodelled::default());
    }

    #[test]
    fn the_coefficient_of_a_single_term_is_that_of_the_value_or_of_its_rate() {
        let mask_of = |wanted: Term| 1 << Term::all().position(|t| t == wanted).unwrap();
        let (first, second) = (Term::Curve { order: 1 }, Term::Curve { order: 2 });
        assert_eq!(per_unit(mask_of(first), ResponseLaw::Linear), Some(1.0));
        assert_eq!(per_unit(mask_of(Term::Rate), ResponseLaw::Rate), Some(1.0));
        assert_eq!(per_unit(mask_of(second), ResponseLaw::Curve), None);
        assert_eq!(per_unit(mask_of(first) | mask_of(second), ResponseLaw::Linear), None);
        // Behind a long ramp of 2 an hour, the term of 150 s comes to −2·150/3600.
        let delay = Term::Delay { time_constant_s: 150.0 };
        let ramp: Vec<f64> = (0..1000).map(|i| 2.0 * f64::from(i) * 10.0 / 3600.0).collect();
        let trailing = delay.course(&ramp, &drivers(1000))[999];
        let scale = per_unit(mask_of(delay), ResponseLaw::Rate).unwrap();
        assert!((scale * 2.0 - trailing).abs() < 1e-9, "{trailing}");
        assert_eq!(per_unit(mask_of(delay), ResponseLaw::Lag), None);
    }

    #[test]
    fn a_stated_response_has_the_course_that_was_fitted() {
        let values = swing(500);
        let drivers = drivers(500);
        // First order, rate, the delay of 940 s, the second play.
        let mask = 0b1_0000_0100_0100_0000_0001;
        let coefficients = [0.5, -0.2, 0.3, 1.5];
        let [center, half] = stated_range(&values);
        let mut stated: Values = stated_lists(mask, &coefficients)
            .into_iter()
            .map(|(name, list)| (name.to_owned(), Value::List(list)))
            .collect();
        stated.insert(CENTER_NAME.to_owned(), Value::Number(center));
        stated.insert(HALF_RANGE.to_owned(), Value::Number(half));
        let course = course(&stated, &values, &drivers).unwrap();
        let columns = regressors(mask, &values, &drivers).columns;
        assert_eq!(columns.len(), 4);
        for (i, got) in course.iter().enumerate() {
            let expected: f64 = coefficients.iter().zip(&columns).map(|(c, x)| c * x[i]).sum();
            assert!((got - expected).abs() < 1e-12);
        }
        assert_eq!(initial_states(&stated, &drivers).len(), 1);
        stated.remove(SCALES_LIST);
        assert!(super::course(&stated, &values, &drivers).is_none());
    }

    #[test]
    fn beyond_its_range_a_curve_goes_on_as_a_line() {
        // P₂ = (3x² − 1)/2 has the slope 3 at 1.
        assert!((legendre(2, 0.5) + 0.125).abs() < 1e-12 && (legendre(2, 1.5) - 2.5).abs() < 1e-12);
        assert!((legendre(2, -1.5) - 2.5).abs() < 1e-12 && (legendre(3, -1.0) + 1.0).abs() < 1e-12);
    }
}
