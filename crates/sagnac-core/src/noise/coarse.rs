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
const OCTAVES: usize = 3;
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
    let coarse = points.iter().take(OCTAVES).any(|p| steps(p) < COARSE_SHARE);
    if step_arcsec.is_nan() || step_arcsec <= 0.0 || !coarse {
        return None;
    }
    let (m, _) = points.iter().find(|p| steps(p) >= MIN_STEPS_MOVED).or(points.last())?;
    Some(0.5 / (*m as f64 * tau0_s))
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
}
