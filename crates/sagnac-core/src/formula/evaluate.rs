//! The value of a formula with its uncertainty, or its bounds where an input is not known.
//!
//! At a risk, every input lies between the bounds of its confidence distribution, and the formula between the ends that follow by
//! arithmetic of intervals. So all inputs err together in the direction that hurts: the worst correlation of normal errors.
//! Where the correlation of inputs is known from one fit, the bounds are moved in by the ratio of the standard uncertainty with the
//! covariance to that without, to first order. The smallest and the largest of several are special: the least of n upper
//! bounds errs where any of them does, so each is taken at an n-th of the risk.
//!
//! An input without a value has the bounds that its limits give, or none. A formula then has those that remain: the largest of a
//! value and an unknown is at least the value.

use super::expression::{Expression, Function, Node, Sign};
use super::interval::Ends;
use crate::estimate::{Estimate, Holds, LowerLimit, Spread, UpperLimit, normal_probability};

/// The correlation of two inputs, each by place of its reference and place among its channels; `None` where it is not known.
pub type Correlations<'a> = dyn Fn((usize, usize), (usize, usize)) -> Option<f64> + 'a;

/// Risk of the bounds of a formula with an input that is not known.
const BOUND_RISK: f64 = 0.05;
/// Largest normal score of the confidence distribution of a formula, and the number of steps to it.
const LARGEST_SCORE: f64 = 4.0;
const SCORES: u32 = 32;
/// Step of a derivative over the standard uncertainty of its input.
const DERIVATIVE_STEP: f64 = 1e-3;
/// Slack of a coverage against a risk.
const SLACK: f64 = 1e-9;

/// One input, on one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// Value in its unit; `None` where the record does not show it.
    pub value: Option<f64>,
    /// Confidence distribution of the value.
    pub spread: Spread,
    /// Part of the standard uncertainty that all tests at the site have in common.
    pub common: f64,
    /// Upper limit, where there is no value.
    pub upper_limit: Option<UpperLimit>,
    /// Lower limit, where there is no value.
    pub lower_limit: Option<LowerLimit>,
    /// Whether it can be negative.
    pub signed: bool,
    /// Factor from its unit to base units.
    pub factor: f64,
}

impl Input {
    /// The input of an estimate, in a unit with a factor to base units. A contradicted estimate has no value: what still holds is a
    /// bound, or nothing.
    pub fn of(estimate: &Estimate, signed: bool, factor: f64) -> Input {
        let mut input = Input {
            value: estimate.value,
            spread: estimate.spread.clone(),
            common: estimate.common(),
            upper_limit: estimate.upper_limit,
            lower_limit: estimate.lower_limit,
            signed,
            factor,
        };
        if let Some(holds) = estimate.contradicted() {
            let bound = estimate.value.and_then(|v| estimate.spread.bound(v, 1.0 - BOUND_RISK));
            let stated =
                bound.map(|value| UpperLimit { value, coverage: 1.0 - BOUND_RISK }).or(input.upper_limit);
            input.upper_limit = stated.filter(|_| holds == Holds::UpperBound);
            (input.value, input.lower_limit, input.spread) = (None, None, Spread::Unknown);
        }
        input
    }

    /// An input of which nothing is known.
    pub fn unknown(signed: bool, factor: f64) -> Input {
        Input {
            value: None,
            spread: Spread::Unknown,
            common: 0.0,
            upper_limit: None,
            lower_limit: None,
            signed,
            factor,
        }
    }

    /// Its ends, each at the risk; `None` where the uncertainty of a value is not known.
    fn ends(&self, risk: f64) -> Option<Ends> {
        let least = if self.signed { f64::NEG_INFINITY } else { 0.0 };
        let (low, high) = if let Some(value) = self.value {
            let (low, high) = (self.spread.bound(value, risk)?, self.spread.bound(value, 1.0 - risk)?);
            (low.max(least), high.max(least))
        } else {
            let holds = |coverage: f64| coverage >= 1.0 - risk - SLACK;
            let low = self.lower_limit.filter(|l| holds(l.coverage)).map_or(least, |l| l.value);
            let high = self.upper_limit.filter(|l| holds(l.coverage)).map_or(f64::INFINITY, |l| l.value);
            (low, high)
        };
        Some(Ends { low: low * self.factor, high: high * self.factor })
    }

    /// Standard uncertainty in base units: half the interval of one sigma.
    fn standard_uncertainty(&self) -> Option<f64> {
        let ends = Input { signed: true, ..self.clone() }.ends(normal_probability(-1.0))?;
        self.value.map(|_| 0.5 * (ends.high - ends.low))
    }
}

/// What is known of a formula, in base units.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Value; `None` where an input has none.
    pub value: Option<f64>,
    /// Confidence distribution of the value.
    pub spread: Spread,
    /// Part of the standard uncertainty that all tests at the site have in common.
    pub common: f64,
    /// Upper limit, where there is no value.
    pub upper_limit: Option<UpperLimit>,
    /// Lower limit, where there is no value.
    pub lower_limit: Option<LowerLimit>,
}

/// The ends of a part of a formula at a risk, for the ends of its inputs.
fn ends(part: &Expression, risk: f64, of: &dyn Fn(usize, f64) -> Option<Ends>) -> Option<Ends> {
    let at = |part: &Expression| ends(part, risk, of);
    Some(match &part.node {
        Node::Number { value, .. } => Ends::exactly(*value),
        Node::Quantity(place) => of(*place, risk)?,
        Node::Negative(inner) => at(inner)?.negative(),
        Node::Binary { sign, left, right } => {
            let (a, b) = (at(left)?, at(right)?);
            match sign {
                Sign::Plus => a.plus(b),
                Sign::Minus => a.minus(b),
                Sign::Times => a.times(b),
                Sign::Over => a.over(b),
            }
        }
        Node::Power { base, exponent } => at(base)?.power(*exponent),
        Node::Call { function: Function::Max, arguments } => {
            let (each, all) = of_several(arguments, risk, of)?;
            Ends { low: Ends::largest(&each).low, high: Ends::largest(&all).high }
        }
        Node::Call { function: Function::Min, arguments } => {
            let (each, all) = of_several(arguments, risk, of)?;
            Ends { low: Ends::smallest(&all).low, high: Ends::smallest(&each).high }
        }
        Node::Call { function, arguments } => {
            let all: Vec<Ends> = arguments.iter().map(at).collect::<Option<_>>()?;
            match function {
                Function::Sqrt => all.first()?.power(0.5),
                Function::Abs => all.first()?.magnitude(),
                Function::Rss => {
                    let squares: Vec<Ends> = all.iter().map(|e| e.power(2.0)).collect();
                    Ends::sum(&squares).power(0.5)
                }
                Function::Min | Function::Max | Function::Mean => {
                    Ends::sum(&all).over(Ends::exactly(all.len() as f64))
                }
            }
        }
    })
}

/// The ends of arguments, first at an equal share of the risk each, then at the whole risk. Where an argument selects too, both are
/// at the share, so that nesting costs no time.
fn of_several(
    arguments: &[Expression],
    risk: f64,
    of: &dyn Fn(usize, f64) -> Option<Ends>,
) -> Option<(Vec<Ends>, Vec<Ends>)> {
    let at = |risk: f64| arguments.iter().map(|a| ends(a, risk, of)).collect::<Option<Vec<Ends>>>();
    let each = at(risk / arguments.len().max(1) as f64)?;
    let all = if arguments.iter().any(selects) { each.clone() } else { at(risk)? };
    Some((each, all))
}

/// True where the smallest or largest of several decides within a part.
fn selects(part: &Expression) -> bool {
    match &part.node {
        Node::Number { .. } | Node::Quantity(_) => false,
        Node::Negative(inner) | Node::Power { base: inner, .. } => selects(inner),
        Node::Binary { left, right, .. } => selects(left) || selects(right),
        Node::Call { function, arguments } => {
            matches!(function, Function::Min | Function::Max | Function::Abs) || arguments.iter().any(selects)
        }
    }
}

/// The worst of the channels of a reference: their largest magnitude. A single one is taken as it is.
fn worst(axes: &[Input], risk: f64) -> Option<Ends> {
    if let [one] = axes {
        return one.ends(risk);
    }
    let at = |risk: f64| {
        let all = axes.iter().map(|a| Some(a.ends(risk)?.magnitude())).collect::<Option<Vec<Ends>>>()?;
        Some(Ends::largest(&all))
    };
    Some(Ends { low: at(risk / axes.len().max(1) as f64)?.low, high: at(risk)?.high })
}

pub(super) fn outcome(root: &Expression, inputs: &[Vec<Input>], correlations: &Correlations<'_>) -> Outcome {
    let axes = |place: usize| inputs.get(place).map(Vec::as_slice).unwrap_or_default();
    let within = |risk: f64| {
        let ends = ends(root, risk, &|place, risk| worst(axes(place), risk));
        ends.filter(|e| !e.low.is_nan() && !e.high.is_nan())
    };
    let known = inputs.iter().flatten().all(|i| i.value.is_some());
    let value = known.then(|| value_at(root, inputs, None)).flatten();
    let Some(value) = value else {
        let bounds = within(BOUND_RISK).unwrap_or(Ends::ALL);
        let coverage = 1.0 - BOUND_RISK;
        return Outcome {
            value: None,
            spread: Spread::Unknown,
            common: 0.0,
            upper_limit: bounds.high.is_finite().then_some(UpperLimit { value: bounds.high, coverage }),
            lower_limit: bounds.low.is_finite().then_some(LowerLimit { value: bounds.low, coverage }),
        };
    };
    let gradient = Gradient::of(root, inputs);
    let scale = if selects(root) || inputs.iter().any(|axes| axes.len() > 1) {
        1.0
    } else {
        gradient.covariance_ratio(correlations)
    };
    let mut curve = vec![(0.0, value)];
    for i in 1..=SCORES {
        let score = LARGEST_SCORE * f64::from(i) / f64::from(SCORES);
        let risk = normal_probability(-score * scale);
        match within(risk) {
            Some(e) if e.low.is_finite() && e.high.is_finite() => {
                curve.insert(0, (-score, e.low.min(value)));
                curve.push((score, e.high.max(value)));
            }
            // Beyond this score nothing bounds it; without any score nothing is known.
            _ => break,
        }
    }
    let spread = if curve.len() > SCORES as usize { Spread::Curve(curve) } else { Spread::Unknown };
    Outcome { value: Some(value), spread, common: gradient.common(), upper_limit: None, lower_limit: None }
}

/// The value of a formula at the values of its inputs, one of them moved.
fn value_at(root: &Expression, inputs: &[Vec<Input>], moved: Option<((usize, usize), f64)>) -> Option<f64> {
    let exact = |place: usize, _: f64| {
        let axes = inputs.get(place)?;
        let value = |i: usize, input: &Input| {
            let by = moved.filter(|(which, _)| *which == (place, i)).map_or(0.0, |(_, by)| by);
            Some(input.value? * input.factor + by)
        };
        let values: Vec<f64> = axes.iter().enumerate().map(|(i, a)| value(i, a)).collect::<Option<_>>()?;
        match values.as_slice() {
            [one] => Some(Ends::exactly(*one)),
            several => several.iter().map(|v| v.abs()).reduce(f64::max).map(Ends::exactly),
        }
    };
    ends(root, 0.5, &exact).map(|e| e.low).filter(|v| v.is_finite())
}

/// Contributions of the inputs: derivative times standard uncertainty, and times the common part of it.
struct Gradient(Vec<Contribution>);

struct Contribution {
    place: (usize, usize),
    own: f64,
    common: f64,
}

impl Gradient {
    fn of(root: &Expression, inputs: &[Vec<Input>]) -> Gradient {
        let mut all = vec![];
        for (place, axes) in inputs.iter().enumerate() {
            for (i, input) in axes.iter().enumerate() {
                let u = input.standard_uncertainty().filter(|u| *u > 0.0);
                let size = u.or_else(|| input.value.map(|v| (v * input.factor).abs())).unwrap_or(0.0);
                let step = DERIVATIVE_STEP * size;
                let at = |by: f64| value_at(root, inputs, Some(((place, i), by)));
                let slope = match (at(step), at(-step)) {
                    (Some(up), Some(down)) if step > 0.0 => (up - down) / (2.0 * step),
                    _ => 0.0,
                };
                all.push(Contribution {
                    place: (place, i),
                    own: slope * u.unwrap_or(0.0),
                    common: slope * input.common * input.factor,
                });
            }
        }
        Gradient(all)
    }

    /// Standard uncertainty with the correlations that are known over that of the worst ones.
    fn covariance_ratio(&self, correlations: &Correlations<'_>) -> f64 {
        let worst: f64 = self.0.iter().map(|c| c.own.abs()).sum();
        let mut variance = 0.0;
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in self.0.iter().enumerate() {
                variance += match correlations(a.place, b.place) {
                    Some(rho) if i != j => rho * a.own * b.own,
                    _ => (a.own * b.own).abs(),
                };
            }
        }
        if worst > 0.0 { (variance.max(0.0).sqrt() / worst).min(1.0) } else { 1.0 }
    }

    /// The common parts err together.
    fn common(&self) -> f64 {
        self.0.iter().map(|c| c.common).sum::<f64>().abs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Formula;
    use super::*;
    use crate::estimate::{SCORE_ONE_SIDED_95, SCORE_TWO_SIDED_95};

    fn normal(value: f64, u: f64) -> Input {
        let spread = Spread::Normal { standard_uncertainty: u };
        Input { value: Some(value), spread, ..Input::unknown(true, 1.0) }
    }

    fn at_most(value: f64) -> Input {
        Input { upper_limit: Some(UpperLimit { value, coverage: 0.95 }), ..Input::unknown(false, 1.0) }
    }

    fn outcome_of(text: &str, inputs: &[Input], rho: Option<f64>) -> Outcome {
        let formula = Formula::parse(text).unwrap();
        let inputs: Vec<Vec<Input>> = inputs.iter().map(|i| vec![i.clone()]).collect();
        formula.evaluate(&inputs, &|a, b| if a == b { Some(1.0) } else { rho })
    }

    /// Standard uncertainty of an outcome, from its 95 % interval.
    fn u(outcome: &Outcome) -> f64 {
        let i = outcome.spread.interval(outcome.value.unwrap(), 0.95).unwrap();
        (i.high - i.low) / (2.0 * SCORE_TWO_SIDED_95)
    }

    #[test]
    fn unknown_correlations_are_the_worst_and_known_ones_count() {
        let ab = [normal(10.0, 0.3), normal(4.0, 0.4)];
        for (text, rho, expected) in [
            ("a + b", None, 0.7),
            ("a - b", None, 0.7),
            ("a + b", Some(0.0), 0.5),
            ("a + b", Some(-1.0), 0.1),
            ("a - b", Some(1.0), 0.1),
            ("a - 2 * b", Some(0.5), (0.09 + 0.64 - 0.24_f64).sqrt()),
            ("-a", None, 0.3),
            ("a / 2", None, 0.15),
        ] {
            let inputs = if text.contains('b') { &ab[..] } else { &ab[..1] };
            let found = u(&outcome_of(text, inputs, rho));
            assert!((found / expected - 1.0).abs() < 1e-3, "{text} {rho:?}: {found} {expected}");
        }
    }

    #[test]
    fn curved_formulas_keep_the_shape_of_their_distribution() {
        // The square of a normal value: its bounds are the squares of the bounds.
        let square = outcome_of("a^2", &[normal(10.0, 1.0)], None);
        let bound = square.spread.bound(100.0, 0.975).unwrap();
        assert!((bound / 11.959_964_f64.powi(2) - 1.0).abs() < 1e-4, "{bound}");
        let deviation =
            Input { value: Some(2.0), spread: Spread::ChiSquare { dof: 8.0 }, ..Input::unknown(false, 1.0) };
        let twice = outcome_of("2 * a", std::slice::from_ref(&deviation), None);
        let (own, made) =
            (deviation.spread.bound(2.0, 0.95).unwrap(), twice.spread.bound(4.0, 0.95).unwrap());
        assert!((made / (2.0 * own) - 1.0).abs() < 1e-3, "{made} {own}");
    }

    #[test]
    fn limits_pass_through_and_leave_what_is_certain() {
        let bounds = |text: &str, inputs: &[Input]| {
            let o = outcome_of(text, inputs, None);
            assert_eq!(o.value, None, "{text}");
            (o.lower_limit.map(|l| l.value), o.upper_limit.map(|l| l.value))
        };
        let z = SCORE_ONE_SIDED_95;
        let near = |found: Option<f64>, expected: f64| {
            assert!((found.unwrap() - expected).abs() < 1e-5, "{found:?}")
        };
        let (low, high) = bounds("a + b", &[normal(3.0, 0.1), at_most(2.0)]);
        near(low, 3.0 - 0.1 * z);
        near(high, 5.0 + 0.1 * z);
        // The larger of a value and an unknown is at least the value; at half the risk, for any of two may err.
        let (low, high) = bounds("max(a, b)", &[normal(3.0, 0.1), Input::unknown(false, 1.0)]);
        near(low, 3.0 - 0.1 * 1.959_964);
        assert_eq!(high, None);
        let (low, high) = bounds("a - b", &[normal(3.0, 0.1), Input::unknown(false, 1.0)]);
        assert_eq!((low, high.is_some()), (None, true));
        assert_eq!(bounds("a / b", &[normal(3.0, 0.1), at_most(2.0)]).1, None);
        assert_eq!(bounds("a * b", &[normal(3.0, 0.1), Input::unknown(true, 1.0)]), (None, None));
    }

    #[test]
    fn the_worst_of_axes_is_their_largest_magnitude() {
        let formula = Formula::parse("worst(a)").unwrap();
        let axes = vec![vec![normal(1.0, 0.1), normal(-3.0, 0.2), normal(2.0, 0.1)]];
        let o = formula.evaluate(&axes, &|_, _| Some(0.0));
        assert_eq!(o.value, Some(3.0));
        let high = o.spread.bound(3.0, 0.95).unwrap();
        assert!((high - (3.0 + 0.2 * 1.644_854)).abs() < 2e-3, "{high}");
    }

    #[test]
    fn without_an_uncertainty_nothing_is_decided() {
        let bare = Input { spread: Spread::Unknown, ..normal(3.0, 0.1) };
        let o = outcome_of("2 * a", &[bare], None);
        assert_eq!((o.value, o.spread), (Some(6.0), Spread::Unknown));
        assert_eq!(outcome_of("1 / (a - a)", &[normal(1.0, 0.1)], None).value, None, "a division by 0");
    }

    #[test]
    fn factors_lead_to_base_units_and_common_parts_add_up() {
        let input = |value, factor| Input { common: 0.1, factor, ..normal(value, 0.2) };
        let o = outcome_of("a + b", &[input(1.0, 2.0), input(3.0, 0.5)], None);
        assert!((o.value.unwrap() - 3.5).abs() < 1e-12 && (o.common - 0.25).abs() < 1e-6, "{o:?}");
        assert!((u(&o) - 0.5).abs() < 1e-3);
    }

    /// Bounds at 5 % of the largest and of a sum err in at most 5 % of draws, whatever the correlation.
    #[test]
    fn bounds_hold_for_correlations_of_any_sign() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(61);
        let mut gauss = move || -> f64 { StandardNormal.sample(&mut rng) };
        let formulas = ["a + b", "max(a, b)", "min(a, b)"];
        for rho in [-0.9_f64, 0.0, 0.9] {
            let mut missed = [[0; 2]; 3];
            let draws = 600;
            for _ in 0..draws {
                let (x, y) = (gauss(), gauss());
                let (a, b) = (5.0 + 0.5 * x, 5.0 + 0.5 * (rho * x + (1.0 - rho * rho).sqrt() * y));
                for (f, text) in formulas.iter().enumerate() {
                    let o = outcome_of(text, &[normal(a, 0.5), normal(b, 0.5)], None);
                    let truth = if f == 0 { 10.0 } else { 5.0 };
                    let bound = |p| o.spread.bound(o.value.unwrap(), p).unwrap();
                    missed[f][0] += usize::from(bound(0.95) < truth);
                    missed[f][1] += usize::from(bound(0.05) > truth);
                }
            }
            // 5 % of 600, and four deviations.
            assert!(missed.iter().flatten().all(|m| *m <= 30 + 21), "{rho}: {missed:?}");
        }
    }
}
