//! Control charts of single values: individuals with their moving ranges, exponentially weighted means, and the rules for
//! patterns that a process in control shows rarely.
//!
//! Every value has a standard uncertainty of its own. What the moving ranges show holds it already; the limits of a point
//! have the spread of the process without measurement and the uncertainty of that point, so that a point of a short test
//! has wider limits than one of a long test.

use std::f64::consts::PI;

/// Fewest values that a chart is made of.
pub const LEAST_VALUES: usize = 5;
/// Values from which its limits are settled (ISO 7870-2).
pub const SETTLED_VALUES: usize = 20;
/// Weight of the newest value in an exponentially weighted mean.
pub const EWMA_WEIGHT: f64 = 0.2;
/// Limits of such a mean in its standard deviations, for a false alarm in 500 values (Lucas and Saccucci 1990).
pub const EWMA_LIMIT: f64 = 2.962;
/// Limits of an individual value in standard deviations.
pub const LIMIT_DEVIATIONS: f64 = 3.0;

/// Mean range of two values of a normal law in standard deviations, d₂ of ISO 7870-2 for n = 2: 1.128.
pub fn d2() -> f64 {
    2.0 / PI.sqrt()
}

/// Upper limit of a range of two values in mean ranges, D₄ of ISO 7870-2 for n = 2: 3.267.
pub fn d4() -> f64 {
    let d3 = (2.0 - 4.0 / PI).sqrt();
    1.0 + LIMIT_DEVIATIONS * d3 / d2()
}

/// A value with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Value.
    pub value: f64,
    /// Standard uncertainty; 0 where it is not known.
    pub standard: f64,
}

/// A rule of the Western Electric handbook, with the name that it has there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// A value beyond three standard deviations.
    Beyond,
    /// Two of three values in a row beyond two standard deviations on the same side.
    TwoOfThree,
    /// Four of five values in a row beyond one standard deviation on the same side.
    FourOfFive,
    /// Eight values in a row on the same side.
    Eight,
}

impl Rule {
    /// Every rule.
    pub const ALL: [Rule; 4] = [Rule::Beyond, Rule::TwoOfThree, Rule::FourOfFive, Rule::Eight];

    /// The id used in records and locale tables.
    pub fn id(self) -> &'static str {
        match self {
            Rule::Beyond => "beyond",
            Rule::TwoOfThree => "two_of_three",
            Rule::FourOfFive => "four_of_five",
            Rule::Eight => "eight",
        }
    }

    /// How many of how many values in a row lie beyond how many standard deviations.
    fn pattern(self) -> (usize, usize, f64) {
        match self {
            Rule::Beyond => (1, 1, LIMIT_DEVIATIONS),
            Rule::TwoOfThree => (2, 3, 2.0),
            Rule::FourOfFive => (4, 5, 1.0),
            Rule::Eight => (8, 8, 0.0),
        }
    }
}

/// A chart of single values.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Mean of the values.
    pub center: f64,
    /// Standard deviation between values that follow each other, by the mean moving range over d₂.
    pub observed: f64,
    /// The part of it that the uncertainties of the values do not explain.
    pub process: f64,
    /// Mean moving range.
    pub mean_range: f64,
    /// The points, in the order of the values.
    pub points: Vec<Point>,
}

/// A point of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Distance between the limits of the value and the center.
    pub reach: f64,
    /// Distance of the value from the value before; `None` for the first.
    pub range: Option<f64>,
    /// Exponentially weighted mean up to here.
    pub ewma: f64,
    /// Distance between its limits and the center.
    pub ewma_reach: f64,
    /// Rules that the values up to here break; the pattern ends with this point.
    pub broken: Vec<Rule>,
    /// True where the exponentially weighted mean is beyond its limits.
    pub ewma_beyond: bool,
}

impl Chart {
    /// The chart of values in the order of time; `None` below [`LEAST_VALUES`], or where all are equal.
    pub fn of(values: &[Measured]) -> Option<Chart> {
        if values.len() < LEAST_VALUES || values.iter().any(|v| !v.value.is_finite()) {
            return None;
        }
        let n = values.len() as f64;
        let center = values.iter().map(|v| v.value).sum::<f64>() / n;
        let ranges: Vec<f64> = values.windows(2).map(range).collect();
        let mean_range = ranges.iter().sum::<f64>() / ranges.len() as f64;
        let observed = mean_range / d2();
        if observed <= 0.0 || !observed.is_finite() {
            return None;
        }
        let measurement = values.iter().map(|v| v.standard * v.standard).sum::<f64>() / n;
        let process = (observed * observed - measurement).max(0.0).sqrt();
        Some(Chart { center, observed, process, mean_range, points: points(values, center, process) })
    }

    /// Upper limit of a moving range.
    pub fn range_limit(&self) -> f64 {
        d4() * self.mean_range
    }

    /// True where no rule is broken and the weighted mean stays within its limits.
    pub fn is_in_control(&self) -> bool {
        self.points.iter().all(|p| p.broken.is_empty() && !p.ewma_beyond)
    }
}

fn range(pair: &[Measured]) -> f64 {
    match pair {
        [a, b] => (b.value - a.value).abs(),
        _ => 0.0,
    }
}

/// The points of values about a center, for a process of known spread.
fn points(values: &[Measured], center: f64, process: f64) -> Vec<Point> {
    let variance = |v: &Measured| process * process + v.standard * v.standard;
    let deviations: Vec<f64> = values.iter().map(|v| (v.value - center) / variance(v).sqrt()).collect();
    let (mut ewma, mut ewma_variance) = (center, 0.0_f64);
    values
        .iter()
        .enumerate()
        .map(|(i, v)| {
            ewma = EWMA_WEIGHT * v.value + (1.0 - EWMA_WEIGHT) * ewma;
            ewma_variance = EWMA_WEIGHT.powi(2) * variance(v) + (1.0 - EWMA_WEIGHT).powi(2) * ewma_variance;
            let ewma_reach = EWMA_LIMIT * ewma_variance.sqrt();
            let until = deviations.get(..=i).unwrap_or_default();
            Point {
                reach: LIMIT_DEVIATIONS * variance(v).sqrt(),
                range: i.checked_sub(1).and_then(|b| Some((v.value - values.get(b)?.value).abs())),
                ewma,
                ewma_reach,
                broken: Rule::ALL.into_iter().filter(|rule| breaks(until, *rule)).collect(),
                ewma_beyond: (ewma - center).abs() > ewma_reach,
            }
        })
        .collect()
}

/// True where a pattern ends with the last of some deviations, which is itself a part of it.
fn breaks(until: &[f64], rule: Rule) -> bool {
    let (needed, of, beyond) = rule.pattern();
    let Some(last) = until.last().filter(|z| z.abs() > beyond) else { return false };
    let recent = until.get(until.len().saturating_sub(of)..).unwrap_or_default();
    let same_side = |z: &&f64| z.signum() == last.signum() && z.abs() > beyond;
    recent.iter().filter(same_side).count() >= needed
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn exact(values: &[f64]) -> Vec<Measured> {
        values.iter().map(|v| Measured { value: *v, standard: 0.0 }).collect()
    }

    #[test]
    fn constants_are_those_of_the_standard() {
        // ISO 7870-2, table 2, n = 2; E2 = 3 / d2 is 2.660.
        assert!((d2() - 1.128).abs() < 5e-4, "{}", d2());
        assert!((d4() - 3.267).abs() < 5e-4, "{}", d4());
        assert!((LIMIT_DEVIATIONS / d2() - 2.660).abs() < 2e-3);
    }

    #[test]
    fn the_chart_of_the_handbook() {
        // NIST/SEMATECH e-Handbook 6.3.2.2: flow rates of 10 batches; mean 50.81, mean range 1.8778, limits 55.8041 and
        // 45.8159.
        let flow = [49.6, 47.6, 49.9, 51.3, 47.8, 51.2, 52.6, 52.4, 53.6, 52.1];
        let chart = Chart::of(&exact(&flow)).unwrap();
        assert!((chart.center - 50.81).abs() < 1e-9, "{}", chart.center);
        assert!((chart.mean_range - 1.8778).abs() < 5e-5, "{}", chart.mean_range);
        let reach = chart.points[0].reach;
        assert!((chart.center + reach - 55.8041).abs() < 5e-3, "{reach}");
        assert!((chart.center - reach - 45.8159).abs() < 5e-3, "{reach}");
    }

    #[test]
    fn uncertainty_of_a_point_widens_its_limits_alone() {
        let mut values = exact(&[1.0, 3.0, 1.0, 3.0, 1.0, 3.0]);
        values.iter_mut().for_each(|v| v.standard = 1.0);
        values[5].standard = 2.0;
        let chart = Chart::of(&values).unwrap();
        let variance = (2.0 / d2()).powi(2) - (5.0 + 4.0) / 6.0;
        assert!((chart.process.powi(2) - variance).abs() < 1e-12);
        assert!((chart.points[0].reach - 3.0 * (variance + 1.0).sqrt()).abs() < 1e-12);
        assert!((chart.points[5].reach - 3.0 * (variance + 4.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn each_rule_ends_with_its_point() {
        let of = |z: &[f64]| -> Vec<Vec<Rule>> {
            points(&exact(z), 0.0, 1.0).into_iter().map(|p| p.broken).collect()
        };
        assert_eq!(of(&[0.5, -3.1])[1], [Rule::Beyond]);
        assert_eq!(of(&[2.1, 0.0, 2.1])[2], [Rule::TwoOfThree]);
        assert!(of(&[2.1, 2.1, 0.0])[2].is_empty(), "it does not end with the last");
        assert!(of(&[2.1, 0.0, -2.1])[2].is_empty(), "not on the same side");
        assert_eq!(of(&[1.1, 1.1, 0.0, 1.1, 1.1])[4], [Rule::FourOfFive]);
        assert_eq!(of(&[0.1; 8])[7], [Rule::Eight]);
        assert!(of(&[0.1; 7])[6].is_empty());
    }

    #[test]
    fn few_or_equal_values_have_no_chart() {
        assert_eq!(Chart::of(&exact(&[1.0, 2.0, 1.0, 2.0])), None);
        assert_eq!(Chart::of(&exact(&[1.0; 9])), None);
        assert_eq!(Chart::of(&exact(&[1.0, f64::NAN, 1.0, 2.0, 1.0])), None);
    }

    /// Mean number of values of a process in control until an alarm.
    fn run_length(alarm: impl Fn(&Point) -> bool) -> f64 {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let (mut alarms, mut total) = (0, 0);
        while alarms < 1500 {
            let values: Vec<f64> = (0..400).map(|_| StandardNormal.sample(&mut random)).collect();
            // A run without an alarm in 400 values goes on as if it began anew: the law has next to no memory.
            match points(&exact(&values), 0.0, 1.0).iter().position(&alarm) {
                Some(at) => {
                    total += at + 1;
                    alarms += 1;
                }
                None => total += values.len(),
            }
        }
        total as f64 / f64::from(alarms)
    }

    #[test]
    fn false_alarms_are_as_rare_as_published() {
        // Champ and Woodall 1987, table 1: the four rules together, 91.75; the first alone, 370.40.
        let all = run_length(|p| !p.broken.is_empty());
        assert!((all / 91.75 - 1.0).abs() < 0.08, "{all}");
        let first = run_length(|p| p.broken.contains(&Rule::Beyond));
        assert!((first / 370.4 - 1.0).abs() < 0.08, "{first}");
        // Lucas and Saccucci 1990, table 3: 500 for weight 0.2 and 2.962, with limits of the settled mean; those of the
        // first values are narrower here, which costs little.
        let ewma = run_length(|p| p.ewma_beyond);
        assert!((ewma / 500.0 - 1.0).abs() < 0.1, "{ewma}");
    }
}
