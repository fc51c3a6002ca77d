//! The level of the noise depends on the input rate.

use crate::effect::shared::noise_level::scale;
use crate::effect::shared::reach::largest_rate;
use crate::effect::shared::variance::{Group, by_value, mean_square, overdispersion};
use crate::effect::sizing::numbers;
use crate::effect::{
    Detector, Domain, Drivers, FlatResidual, Law, Level, LevelDetector, LevelLaw, Param, Place, Samples,
    Values, number,
};
use crate::numeric::optimize::{bisect, golden_section};
use crate::numeric::range::ends;

pub struct NoiseVarianceRate;

static PARAMS: [Param; 2] = [Param::reported("ratio", "", 1e-3, 1e3), Param::inner("exponent", "", 1.0, 2.0)];

describe! {
    NoiseVarianceRate, "noise_variance_rate", Samples in InputRate, needs [TableRate],
    confusers [NoiseVarianceTime, SfNonlinearity, ResetRipple],
    properties [carried_over]
}

impl Samples for NoiseVarianceRate {
    fn apply(&self, values: &Values, drivers: &Drivers, _seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        let (Some(ratio), Some(table)) = (number(values, PARAMS[0].name), &drivers.table_rate) else {
            return;
        };
        let largest = largest_rate(drivers);
        if largest <= 0.0 {
            return;
        }
        let exponent = number(values, PARAMS[1].name).unwrap_or(2.0);
        let gain = |i: usize| {
            let share = table.get(i).map_or(0.0, |r| (r.abs() / largest).powf(exponent));
            (1.0 + (ratio * ratio - 1.0) * share).max(0.0).sqrt()
        };
        scale(drivers, rate, gain);
    }

    fn detector(&self) -> Detector {
        Detector::Level(&NoiseVarianceRate)
    }
}

impl LevelDetector for NoiseVarianceRate {
    fn laws(&self, residual: &FlatResidual<'_>, samples: &[usize]) -> Vec<LevelLaw> {
        let rate = residual.drivers.table_rate.as_deref().filter(|r| ends(r).is_wide());
        rate.and_then(|rate| over_rate(rate, residual, samples)).into_iter().collect()
    }

    fn stated(&self, level: &Level, _drivers: &Drivers) -> Values {
        let Law::Rate { exponent, .. } = &level.law else { return Values::new() };
        numbers([(PARAMS[1].name, f64::from(*exponent))])
    }
}

/// The law over the size of the rate.
fn over_rate(rate: &[f64], residual: &FlatResidual<'_>, samples: &[usize]) -> Option<LevelLaw> {
    let (groups, sizes) = by_value(|i| rate[i].abs(), &residual.flat, samples);
    let largest = rate.iter().fold(0.0, |a: f64, r| a.max(r.abs()));
    if !ends(&sizes).is_wide() {
        return None;
    }
    let RateLaw { ratio, exponent, ci95, gain } = rate_law(&groups, &sizes, largest)?;
    let power = |r: f64| 1.0 + (ratio * ratio - 1.0) * (r.abs() / largest).powi(i32::from(exponent));
    let logs: Vec<f64> = {
        let scale = mean_square(
            &groups
                .iter()
                .zip(&sizes)
                .map(|(g, s)| Group { square: g.square / power(*s), dof: g.dof })
                .collect::<Vec<Group>>(),
        );
        sizes.iter().map(|s| (scale * power(*s)).ln()).collect()
    };
    // Half of the way from the lowest to the highest variance.
    let from = largest * 0.5f64.powf(1.0 / f64::from(exponent));
    let (low, high) = if ratio >= 1.0 { (from, largest) } else { (0.0, from) };
    Some(LevelLaw {
        law: Law::Rate { ratio, exponent },
        profile: rate.iter().map(|r| power(*r).sqrt()).collect(),
        gain,
        trials: 2.0,
        free: 1,
        parameters: 1,
        dispersion: overdispersion(&groups, &logs, 2),
        ratio,
        ci95,
        place: Place { domain: Domain::InputRate, from: low, to: high },
    })
}

/// The law, fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RateLaw {
    /// Deviation at the largest rate over that at zero.
    ratio: f64,
    /// q, 1 or 2.
    exponent: u8,
    /// Interval of the ratio by profile likelihood, 95 %.
    ci95: [f64; 2],
    /// Gain of log-likelihood over one level.
    gain: f64,
}

/// Bound of the logarithm of the ratio, either way.
const MAX_LOG_RATIO: f64 = 5.0;

/// Fits the law to groups with mean |Ω| in `sizes`.
fn rate_law(groups: &[Group], sizes: &[f64], largest: f64) -> Option<RateLaw> {
    if largest <= 0.0 || groups.len() < 4 {
        return None;
    }
    let one = |exponent: u8| {
        let shares: Vec<f64> = sizes.iter().map(|s| (s / largest).powi(i32::from(exponent))).collect();
        let value = |log_ratio: f64| likelihood(groups, &shares, log_ratio);
        let steps = (0..=40).map(|i| MAX_LOG_RATIO * (f64::from(i) / 20.0 - 1.0));
        let start = steps.max_by(|a, b| value(*a).total_cmp(&value(*b)))?;
        let at = golden_section(start - 0.25, start + 0.25, 40, |x| -value(x));
        let top = value(at);
        // χ²₁ at 95 % is 3.841.
        let end = |side: f64| crossing(value, at, side * 2.0 * MAX_LOG_RATIO, top - 0.5 * 3.841_459);
        let ci95 = [end(-1.0).exp(), end(1.0).exp()];
        Some(RateLaw { ratio: at.exp(), exponent, ci95, gain: top - value(0.0) })
    };
    [one(1), one(2)].into_iter().flatten().max_by(|a, b| a.gain.total_cmp(&b.gain))
}

/// Log-likelihood with the level at zero rate at its best.
fn likelihood(groups: &[Group], shares: &[f64], log_ratio: f64) -> f64 {
    let excess = (2.0 * log_ratio).exp_m1();
    let factors: Vec<f64> = shares.iter().map(|s| (1.0 + excess * s).max(1e-12)).collect();
    let scaled: Vec<Group> =
        groups.iter().zip(&factors).map(|(g, f)| Group { square: g.square / f, dof: g.dof }).collect();
    let dof: f64 = groups.iter().map(|g| g.dof).sum();
    let logs: f64 = groups.iter().zip(&factors).map(|(g, f)| g.dof * f.ln()).sum();
    -0.5 * logs - 0.5 * dof * mean_square(&scaled).max(1e-300).ln()
}

/// The place where the value falls to `down` between `at` and `at + reach`.
fn crossing(value: impl Fn(f64) -> f64, at: f64, reach: f64, down: f64) -> f64 {
    let outside = at + reach;
    if value(outside) > down {
        return outside;
    }
    bisect(at, outside, 50, |x| value(x) > down).inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_comes_back_from_mean_squares_that_follow_it() {
        let sizes: Vec<f64> = (0..40).map(|i| f64::from(i) / 4.0).collect();
        for (ratio, exponent) in [(2.0f64, 2u8), (1.5, 1), (0.6, 2)] {
            let power = |s: &f64| 0.3 * (1.0 + (ratio * ratio - 1.0) * (s / 9.75).powi(i32::from(exponent)));
            let groups: Vec<Group> = sizes.iter().map(|s| Group { square: power(s), dof: 500.0 }).collect();
            let law = rate_law(&groups, &sizes, 9.75).unwrap();
            assert!((law.ratio / ratio - 1.0).abs() < 1e-4 && law.exponent == exponent, "{law:?}");
            assert!(law.ci95[0] < ratio && ratio < law.ci95[1] && law.gain > 100.0, "{law:?}");
            // ½ Σ n ln of the mean over the own level, with the ratio at its truth.
            let dof = 40.0 * 500.0;
            let mean = groups.iter().map(|g| g.square).sum::<f64>() / 40.0;
            let expected =
                0.5 * (dof * mean.ln() - groups.iter().map(|g| 500.0 * g.square.ln()).sum::<f64>());
            assert!((law.gain / expected - 1.0).abs() < 1e-6, "{law:?} {expected}");
        }
        assert!(rate_law(&[], &[], 1.0).is_none());
    }

    #[test]
    fn the_level_is_the_claimed_one_at_rest_and_the_ratio_at_the_largest_rate() {
        let table = vec![0.0, 5.0, -10.0, 10.0];
        let drivers =
            Drivers { dt_s: 1.0, samples: 4, table_rate: Some(table.clone()), ..Drivers::default() };
        let mut rate: Vec<f64> = table.iter().map(|r| 3600.0 * r + 1.0).collect();
        let values = numbers([("ratio", 2.0)]);
        NoiseVarianceRate.apply(&values, &drivers, 1, &mut rate, &mut [true; 4]);
        let left: Vec<f64> = rate.iter().zip(&table).map(|(y, r)| y - 3600.0 * r).collect();
        for (got, expected) in left.iter().zip([1.0, 1.75f64.sqrt(), 2.0, 2.0]) {
            assert!((got - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn a_residual_that_follows_the_law_gives_it_back_with_its_place() {
        // Ten sizes of the rate with sixteen samples each; the deviation doubles at the largest.
        let rate: Vec<f64> =
            (0..160).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 } * (i / 16) as f64).collect();
        let power = |r: f64| 1.0 + 3.0 * (r / 9.0).powi(2);
        let drivers =
            Drivers { dt_s: 1.0, samples: 160, table_rate: Some(rate.clone()), ..Drivers::default() };
        let residual = FlatResidual {
            white: vec![],
            flat: rate.iter().map(|r| 0.5 * power(*r).sqrt()).collect(),
            per_deg_h: 1.0,
            ends: 0,
            usable: &[],
            drivers: &drivers,
            rounding_step: 0.0,
        };
        let samples: Vec<usize> = (0..160).collect();
        let [law] = &NoiseVarianceRate.laws(&residual, &samples)[..] else { panic!("one law") };
        assert!((law.ratio / 2.0 - 1.0).abs() < 1e-4);
        assert!(matches!(law.law, Law::Rate { exponent: 2, .. }), "{:?}", law.law);
        for (profile, r) in law.profile.iter().zip(&rate) {
            assert!((profile - power(*r).sqrt()).abs() < 1e-3);
        }
        // Half of the way in variance is at 1/√2 of the largest rate; squares without scatter are not overdispersed.
        assert!((law.place.from - 9.0 * 0.5f64.sqrt()).abs() < 1e-12 && law.place.to == 9.0);
        assert_eq!((law.place.domain, law.dispersion), (Domain::InputRate, 1.0));
        // A table at one size of rate tells nothing.
        let steady = Drivers { table_rate: Some(vec![3.0; 160]), ..drivers.clone() };
        assert!(NoiseVarianceRate.laws(&FlatResidual { drivers: &steady, ..residual }, &samples).is_empty());
    }
}
