//! Whether the output had settled at the rates of the table before they were evaluated.

use crate::estimate::{Finding, Holds};
use crate::evidence::TableEvidence;
use crate::message::{Arg, note};
use crate::rate_table::late::Late;

/// Everything that rests on the means of steps.
const OF_STEPS: [&str; 15] = [
    "scale_factor",
    "scale_factor_error",
    "scale_factor_nonlinearity",
    "scale_factor_nonlinearity_of_rate",
    "scale_factor_residual",
    "scale_factor_asymmetry",
    "scale_factor_odd",
    "scale_factor_even",
    "scale_factor_repeatability",
    "scale_factor_hysteresis",
    "scale_factor_temperature_sensitivity",
    "scale_factor_bias",
    "sine_response",
    "dead_zone",
    "threshold",
];
/// Share of the change of rate over the relative standard uncertainty of the scale factor from which it matters.
const MATTERS_FROM: f64 = 0.5;
/// Relative standard uncertainty of a scale factor that counts at most: what is later than steps are long makes it large itself.
const MOST_UNCERTAINTY: f64 = 0.01;

/// Finds an output that follows the table late.
pub(super) fn examine(table: &TableEvidence<'_>) -> Vec<Finding> {
    let Some(Late { share, .. }) = Late::of(table.steps, table.gyro) else { return vec![] };
    let known = table.line.as_ref().map_or(0.0, |line| line.factor_uncertainty() / line.factor.abs());
    if share.value.abs() < MATTERS_FROM * known.min(MOST_UNCERTAINTY) {
        return vec![];
    }
    vec![Finding {
        measurands: OF_STEPS.to_vec(),
        holds: Holds::Nothing,
        found: note!(
            "criticism_found.late_output",
            share_ppm = Arg::figures(1e6 * share.value, 2),
            sigma = Arg::figures((share.value / share.standard).abs(), 2)
        ),
        advice: note!("criticism_advice.late_output", settling_s = Arg::figures(table.setup.settling_s, 2)),
    }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::test_evidence::{part, steps, within};
    use crate::rate_table::steps::Steps;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Rates up and down three times; the output has white noise and follows with a time constant, in parts of 5 s.
    fn table(time_constant_s: f64, noise: f64, seed: u64) -> Steps {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let up = [-1000.0, -400.0, -100.0, 0.0, 100.0, 400.0, 1000.0];
        let cycle = up.iter().chain(up.iter().rev().skip(1).take(5));
        let rates: Vec<f64> = cycle.clone().chain(cycle.clone()).chain(cycle).copied().collect();
        let mut found = steps(&rates, &rates, 12);
        let mut output = rates[0];
        for step in &mut found.list {
            let rate = step.rate;
            step.parts = (0..4)
                .map(|k| {
                    let kept = (-5.0 / time_constant_s).exp();
                    let mean = rate + (output - rate) * (1.0 - kept) * time_constant_s / 5.0;
                    output = rate + (output - rate) * kept;
                    let scatter: f64 = StandardNormal.sample(&mut rng);
                    part(k, rate, mean + noise * scatter)
                })
                .collect();
        }
        found
    }

    #[test]
    fn an_output_that_follows_late_is_seen_with_its_share() {
        // Behind 3 s the mean of 20 s holds 3/20 (1 − e^(−20/3)) of the change, and that of the later 10 s 3/10 of e^(−10/3).
        let late = Late::of(&table(3.0, 1.0, 1), 0).unwrap();
        let left = |from: f64| 3.0 / (20.0 - from) * ((-from / 3.0f64).exp() - (-20.0 / 3.0f64).exp());
        within(late.share.value, left(0.0) - left(10.0), 0.02);
    }

    #[test]
    fn an_output_that_takes_many_steps_to_follow_is_seen() {
        assert!(Late::of(&table(300.0, 0.1, 1), 0).is_some());
    }

    #[test]
    fn a_scale_factor_that_changes_while_the_unit_warms_is_not_late() {
        let mut heated = table(1e-9, 1e-3, 5);
        let mut warm = 0.0;
        for step in &mut heated.list {
            for part in &mut step.parts {
                warm += ((part.rate / 1000.0).powi(2) - warm) * 0.2;
                part.temperature = 25.0 + warm;
                part.gyro[0] += 1e-4 * warm * part.rate;
            }
        }
        assert_eq!(Late::of(&heated, 0), None);
        heated.list.iter_mut().flat_map(|s| &mut s.parts).for_each(|p| p.temperature = f64::NAN);
        assert!(Late::of(&heated, 0).is_some(), "without the temperature the two are alike");
    }

    #[test]
    fn noise_is_not_late() {
        let seen = (0..400).filter(|seed| Late::of(&table(1e-3, 1.0, *seed), 0).is_some()).count();
        assert_eq!(seen, 0);
        assert_eq!(Late::of(&steps(&[0.0, 100.0, 0.0], &[0.0, 100.0, 0.0], 3), 0), None);
    }
}
