//! Random processes integrated in time: relaxation, resonance, two levels.

use super::dice::Dice;
use std::f64::consts::TAU;

/// Exponentially correlated noise of a standard deviation, begun in its stationary state.
pub fn relaxation(dice: &mut Dice, length: usize, step_s: f64, time_constant_s: f64, sigma: f64) -> Vec<f64> {
    let kept = (-step_s / time_constant_s).exp();
    let fresh = sigma * (1.0 - kept * kept).sqrt();
    let mut state = sigma * dice.normal();
    (0..length)
        .map(|_| {
            let now = state;
            state = kept * state + fresh * dice.normal();
            now
        })
        .collect()
}

/// A resonance struck by noise: a damped oscillator of a standard deviation, turned and damped from step to step and
/// averaged over four of them. The decay time is that of the amplitude.
pub fn resonance(
    dice: &mut Dice,
    length: usize,
    step_s: f64,
    frequency_hz: f64,
    decay_s: f64,
    sigma: f64,
) -> Vec<f64> {
    let fine = step_s / 4.0;
    let kept = (-fine / decay_s).exp();
    let (sin, cos) = (TAU * frequency_hz * fine).sin_cos();
    let fresh = sigma * (1.0 - kept * kept).sqrt();
    let (mut x, mut y) = (sigma * dice.normal(), sigma * dice.normal());
    (0..length)
        .map(|_| {
            let mut sum = 0.0;
            for _ in 0..4 {
                sum += x;
                let turned = (kept * (cos * x - sin * y), kept * (sin * x + cos * y));
                x = turned.0 + fresh * dice.normal();
                y = turned.1 + fresh * dice.normal();
            }
            sum / 4.0
        })
        .collect()
}

/// Instants of a Poisson process within a duration.
pub fn instants(dice: &mut Dice, duration_s: f64, mean_wait_s: f64) -> Vec<f64> {
    let mut all = vec![];
    let mut at = dice.waiting(mean_wait_s);
    while at < duration_s {
        all.push(at);
        at += dice.waiting(mean_wait_s);
    }
    all
}

/// Two levels, ±½, left after exponential waits. Each value is the mean over its step.
pub fn two_levels(dice: &mut Dice, length: usize, step_s: f64, mean_dwell_s: f64) -> Vec<f64> {
    let mut level = 0.5 * dice.sign();
    let mut left = dice.waiting(mean_dwell_s);
    (0..length)
        .map(|_| {
            let (mut rest, mut sum) = (step_s, 0.0);
            while left < rest {
                sum += level * left;
                rest -= left;
                level = -level;
                left = dice.waiting(mean_dwell_s);
            }
            left -= rest;
            (sum + level * rest) / step_s
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relaxation_forgets_after_its_time_constant() {
        let x = relaxation(&mut Dice::new(1), 400_000, 1.0, 10.0, 2.0);
        let at = |lag: usize| x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>() / x.len() as f64;
        assert!((at(0) - 4.0).abs() < 0.15, "{}", at(0));
        assert!((at(10) / at(0) - (-1f64).exp()).abs() < 0.02, "{}", at(10) / at(0));
    }

    #[test]
    fn a_resonance_turns_at_its_frequency_and_decays() {
        // Autocorrelation: damped cosine; two periods of 20 s are one decay time.
        let x = resonance(&mut Dice::new(2), 400_000, 1.0, 0.05, 40.0, 1.0);
        let at = |lag: usize| x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>() / x.len() as f64;
        assert!((at(0) - 1.0).abs() < 0.05, "{}", at(0));
        assert!((at(40) - (-1f64).exp()).abs() < 0.04, "{}", at(40));
        assert!((at(10) + (-0.25f64).exp()).abs() < 0.04, "{}", at(10));
    }

    #[test]
    fn two_levels_dwell_as_long_as_asked() {
        let x = two_levels(&mut Dice::new(3), 200_000, 1.0, 50.0);
        let jumps = x.windows(2).filter(|w| w[0] * w[1] < 0.0).count() as f64;
        assert!((200_000.0 / jumps / 50.0 - 1.0).abs() < 0.06, "{jumps}");
    }
}
