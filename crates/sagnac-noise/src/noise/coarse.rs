//! Up to which frequency a coarsely rounded output tells its noise.
//!
//! The error of rounding an angle is white and free of the signal only where noise moves the angle by about a step from
//! one sample to the next (Widrow and Kollár, Quantization Noise, 2008). Where it does not, the output repeats patterns:
//! lines and humps that no instrument has, and a floor far below its angle random walk. Over times in which the angle
//! moves by some steps they are averaged out.

/// Allan deviation times τ, in steps, below which the output is coarse where one of the first octaves has it. Rounding
/// alone gives a half; with noise of half a step a sample it is 0.7 from the first octave on.
const COARSE_SHARE: f64 = 0.7;
/// Octaves that are looked at: a pattern of two levels that alternate is large in the first alone.
const EXAMINED_OCTAVES: usize = 3;
/// The same of the shortest time that is used.
const MIN_STEPS_MOVED: f64 = 2.0;

/// The highest frequency that is used, Hz; `None` where rounding is fine enough for all of them.
///
/// `step_deg_h` is the step that all values are multiples of, `points` are averaging factors with their Allan
/// deviations (deg/h), ascending.
pub fn highest_hz(step_deg_h: f64, tau0_s: f64, points: &[(u64, f64)]) -> Option<f64> {
    let step_arcsec = step_deg_h * tau0_s;
    let steps = |(m, deviation): &(u64, f64)| deviation * (*m as f64 * tau0_s) / step_arcsec;
    points.first().filter(|p| p.0 == 1)?;
    let coarse = points.iter().take(EXAMINED_OCTAVES).any(|p| steps(p) < COARSE_SHARE);
    if step_arcsec.is_nan() || step_arcsec <= 0.0 || !coarse {
        return None;
    }
    let (m, _) = points.iter().find(|p| steps(p) >= MIN_STEPS_MOVED).or(points.last())?;
    Some(0.5 / (*m as f64 * tau0_s))
}

/// Allan deviation of single samples, in steps, below which noise does not carry a rounded rate from step to step: half a step of noise
/// beside that of rounding. Above it the mean is off by less than 0.3 % of a step (Widrow and Kollár).
const MIN_DITHER_STEPS: f64 = 0.577;
/// Growth of the squared deviation times τ² from one sample to four from which a remainder is not carried on. It grows
/// fourfold where samples are independent, and less than 2.5 times where the angle was rounded.
const FORGOTTEN_GROWTH: f64 = 3.0;

/// Whether rounding of the rate hides what the unit does.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum RateRounding {
    /// Finer than the noise, or its remainder is carried on.
    #[default]
    Harmless,
    /// Coarser than the noise, and the remainder of each sample is lost.
    Forgotten {
        /// Step of the rate, deg/h.
        step_deg_h: f64,
    },
    /// All samples are equal: steps of unknown size hide all that the unit does.
    Constant,
}

impl RateRounding {
    /// The rounding that Allan deviations show; `step_deg_h` is the step that all values are multiples of, where there is one, and
    /// `points` are as in [`highest_hz`].
    pub fn of(step_deg_h: Option<f64>, points: &[(u64, f64)]) -> RateRounding {
        let constant = points.first().is_some_and(|p| *p == (1, 0.0));
        match step_deg_h {
            _ if constant => RateRounding::Constant,
            Some(step_deg_h) if is_forgotten(step_deg_h, points) => RateRounding::Forgotten { step_deg_h },
            _ => RateRounding::Harmless,
        }
    }
}

/// True where a rate was rounded, sample by sample, and noise does not carry it from step to step. `points` as in [`highest_hz`].
fn is_forgotten(step_deg_h: f64, points: &[(u64, f64)]) -> bool {
    let at = |m: u64| points.iter().find(|p| p.0 == m).map(|p| p.1 * m as f64 / step_deg_h);
    let (Some(one), Some(four)) = (at(1), at(4)) else { return false };
    one < MIN_DITHER_STEPS && four * four > FORGOTTEN_GROWTH * one * one
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fine_rounding_leaves_all_frequencies_and_coarse_rounding_those_where_noise_moves_the_angle() {
        let tau0_s = 0.1;
        let points = |n: f64, q: f64| -> Vec<(u64, f64)> {
            let at = |m: u64| {
                let tau_s = m as f64 * tau0_s;
                (3.0 * q * q / (tau_s * tau_s) + 3600.0 * n * n / tau_s).sqrt()
            };
            (0..14).map(|k| (1 << k, at(1 << k))).collect()
        };
        // A step of half an arcsecond; 60 N √τ0 arcsec a sample.
        let step = 0.5 / tau0_s;
        let q = 0.5 / 12f64.sqrt();
        assert_eq!(highest_hz(step, tau0_s, &points(0.03, q)), None);
        // N of 0.0008: 0.048 √τ arcsec; one arcsecond after 434 s, and half a step of rounding beside.
        let highest = highest_hz(step, tau0_s, &points(0.0008, q)).unwrap();
        assert!((0.5 / 820.0..0.5 / 400.0).contains(&highest), "{highest}");
        assert_eq!(highest_hz(f64::NAN, tau0_s, &points(0.0008, q)), None);
        assert_eq!(highest_hz(step, tau0_s, &[]), None);
    }
    #[test]
    fn a_rounded_rate_forgets_its_remainder_and_a_rounded_angle_carries_it_on() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        for (noise, bias) in [(0.1, 11.75), (0.3, 3.2), (0.05, 7.52), (0.45, 0.1)] {
            let rates: Vec<f64> = (0..20_000)
                .map(|_| {
                    bias + noise * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng)
                })
                .collect();
            let mut angle = 0.0f64;
            let increments: Vec<f64> = rates
                .iter()
                .map(|rate| {
                    let before = angle.round();
                    angle += rate;
                    angle.round() - before
                })
                .collect();
            let points = |values: &[f64]| -> Vec<(u64, f64)> {
                let deviation = |m: usize| {
                    let sum = |at: usize| values[at..at + m].iter().sum::<f64>();
                    let squares = (0..values.len() - 2 * m).map(|i| (sum(i + m) - sum(i)).powi(2));
                    let count = values.len() - 2 * m;
                    (0.5 * squares.sum::<f64>() / count as f64).sqrt() / m as f64
                };
                vec![(1, deviation(1)), (2, deviation(2)), (4, deviation(4))]
            };
            let rounded: Vec<f64> = rates.iter().map(|r| r.round()).collect();
            assert!(is_forgotten(1.0, &points(&rounded)), "{noise} {bias}");
            assert!(!is_forgotten(1.0, &points(&increments)), "{noise} {bias}");
        }
        // Noise of a step carries a rounded rate on.
        assert!(!is_forgotten(1.0, &[(1, 1.04), (2, 0.73), (4, 0.52)]));
    }

    #[test]
    fn equal_samples_tell_nothing_of_their_step() {
        assert_eq!(RateRounding::of(None, &[(1, 0.0), (2, 0.0)]), RateRounding::Constant);
        assert_eq!(RateRounding::of(None, &[(1, 0.1), (2, 0.07)]), RateRounding::Harmless);
        assert_eq!(RateRounding::of(None, &[]), RateRounding::Harmless);
        let rare = [(1, 0.02), (2, 0.0142), (4, 0.01)];
        assert_eq!(RateRounding::of(Some(1.0), &rare), RateRounding::Forgotten { step_deg_h: 1.0 });
    }
}
