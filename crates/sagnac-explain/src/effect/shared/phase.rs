//! The phase of a column that runs through its range again and again: a ramp that is reset, an angle that wraps.

use super::polynomial::Scale;
use super::sinusoid::{averaged, pair};

/// Fewest resets of a column that counts as such a ramp.
const MIN_RESETS: usize = 8;
/// Share of the range by which the column falls back at a reset, at least.
const MIN_RESET_SHARE: f64 = 0.5;
/// Share of the resets that may go the other way.
const OTHER_WAY: f64 = 0.1;

/// The phase of a ramp, in periods.
pub(in crate::effect) struct Phase {
    /// At each sample.
    at: Vec<f64>,
    /// Its change over the interval of each sample.
    step: Vec<f64>,
}

impl Phase {
    /// That of a column; `None` where it does not run through its range again and again in one direction.
    pub fn of(values: &[f64], scale: Scale) -> Option<Phase> {
        let range = 2.0 * scale.half;
        if values.len() < 2 || range.is_nan() || range <= 0.0 {
            return None;
        }
        let at: Vec<f64> = values.iter().map(|v| (v - (scale.center - scale.half)) / range).collect();
        let falls = at.windows(2).filter(|w| w[1] - w[0] < -MIN_RESET_SHARE).count();
        let rises = at.windows(2).filter(|w| w[1] - w[0] > MIN_RESET_SHARE).count();
        let (most, least) = (falls.max(rises), falls.min(rises));
        // A noisy column jumps over half of its range in both directions.
        if most < MIN_RESETS || least as f64 > OTHER_WAY * most as f64 {
            return None;
        }
        let wrapped = |d: f64| d - d.round();
        let mut step: Vec<f64> = at.windows(2).map(|w| wrapped(w[1] - w[0])).collect();
        step.extend(step.last().copied());
        Some(Phase { at, step })
    }

    /// Periods that it runs through, without sign.
    pub fn periods(&self) -> f64 {
        self.step.iter().take(self.at.len().saturating_sub(1)).sum::<f64>().abs()
    }

    /// The typical change over a sample, without sign.
    pub fn typical_step(&self) -> f64 {
        let mut steps: Vec<f64> = self.step.iter().map(|s| s.abs()).collect();
        let middle = steps.len() / 2;
        if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
    }

    /// Cosine and sine of a harmonic, as means over each sample.
    pub fn harmonic(&self, order: u32) -> Vec<Vec<f64>> {
        let order = f64::from(order);
        pair(self.at.len(), |i| (order * self.at[i], averaged(order * self.step[i])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Option<Phase> {
        Phase::of(values, Scale::of(values))
    }

    #[test]
    fn a_ramp_that_is_reset_has_a_phase_and_others_have_none() {
        let ramp: Vec<f64> = (0..2000).map(|i| 5.0 + 3.0 * (f64::from(i) / 37.3).fract()).collect();
        let phase = of(&ramp).unwrap();
        assert!((phase.periods() - 1999.0 / 37.3).abs() < 0.2, "{}", phase.periods());
        assert!((phase.typical_step() - 1.0 / 37.3).abs() < 1e-4, "{}", phase.typical_step());
        let falling: Vec<f64> = ramp.iter().map(|v| -v).collect();
        assert!((of(&falling).unwrap().periods() - 1999.0 / 37.3).abs() < 0.2);
        let sine: Vec<f64> = (0..2000).map(|i| (f64::from(i) / 10.0).sin()).collect();
        let scatter: Vec<f64> = (0..2000u64).map(|i| ((i * i) % 1009) as f64).collect();
        let square: Vec<f64> = (0..2000).map(|i| f64::from(i / 50 % 2)).collect();
        assert!([sine, scatter, square, vec![1.0; 50], vec![]].iter().all(|v| of(v).is_none()));
    }

    #[test]
    fn harmonics_are_sinusoids_of_the_phase() {
        let ramp: Vec<f64> = (0..500).map(|i| (f64::from(i) / 50.0).fract()).collect();
        let range = Scale { center: 0.5, half: 0.5 };
        let [cosine, sine] = &Phase::of(&ramp, range).unwrap().harmonic(3)[..] else { panic!("not two") };
        let left = averaged(3.0 / 50.0);
        let angle = std::f64::consts::TAU * 3.0 * 7.0 / 50.0;
        assert!((cosine[7] - left * angle.cos()).abs() < 1e-9 && (sine[7] - left * angle.sin()).abs() < 1e-9);
    }
}
