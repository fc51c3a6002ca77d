//! Records whose output is rounded to steps larger than the noise of a sample.
//!
//! The error of rounding an angle is even and free of memory only where the angle moves by about a step from one sample
//! to the next. Where it does not, samples are averaged until it does: the mean of m samples is a sample of m times the
//! interval, rounded to the same angle.

use super::regular::{Grid, Regular};
use crate::claim::Claim;
use crate::effect::Column;

/// Fewest samples that are left.
const MIN_SAMPLES: usize = 1024;

/// Number of samples to average so that white noise moves the angle by two steps of `lsb_arcsec` between two of them; 1
/// where it moves it by one from sample to sample.
pub fn group(lsb_arcsec: f64, claim: &Claim, samples: usize) -> usize {
    let dt_s = 1.0 / claim.sample_rate_hz;
    // 1 deg/h over 1 s is 1 arcsec.
    // White noise that a claim only bounds moves it by no more.
    let n = if claim.noise.n > 0.0 { claim.noise.n } else { claim.uncertainty.of_zero()[0] };
    let moved_arcsec = 60.0 * n * dt_s.sqrt();
    if lsb_arcsec <= moved_arcsec || moved_arcsec <= 0.0 {
        return 1;
    }
    // Two steps: then rounding has a twentieth of the variance of the noise, and its flat law shows in no tail.
    let wanted = (2.0 * lsb_arcsec / moved_arcsec).powi(2).ceil();
    (wanted as usize).clamp(1, (samples / MIN_SAMPLES).max(1))
}

/// The recording in averages over `m` samples with what the claim expects averaged as well: on a table that turns, the
/// mean of what is expected is not what is expected at the mean angle. `expected` gives the latter of a recording.
pub fn about_the_claim(regular: &Regular, m: usize, expected: impl Fn(&Regular) -> Vec<f64>) -> Regular {
    let mut out = averaged(regular, m);
    let fine = crate::effect::averages(&expected(regular), m);
    let coarse = expected(&out);
    for ((rate, fine), coarse) in out.rate.iter_mut().zip(&fine).zip(&coarse) {
        *rate += coarse - fine;
    }
    out
}

/// The recording in averages over `m` samples. An average counts as present where all its samples are.
pub fn averaged(regular: &Regular, m: usize) -> Regular {
    let means = |values: &[f64]| crate::effect::averages(values, m);
    let mut columns: std::collections::BTreeMap<Column, Vec<f64>> =
        regular.columns.iter().map(|(c, v)| (*c, means(v))).collect();
    if let (Some(mean), Some(angle)) =
        (columns.get_mut(&Column::TableAngle), regular.columns.get(&Column::TableAngle))
    {
        // Angles turn over: their means are those of the direction.
        let part = |f: fn(f64) -> f64| means(&angle.iter().map(|a| f(a.to_radians())).collect::<Vec<f64>>());
        let (sin, cos) = (part(f64::sin), part(f64::cos));
        *mean = sin.iter().zip(&cos).map(|(s, c)| s.atan2(*c).to_degrees().rem_euclid(360.0)).collect();
    }
    let fine = &regular.grid;
    let grid = Grid {
        dt_s: fine.dt_s * m as f64,
        start_s: fine.start_s + 0.5 * (m - 1) as f64 * fine.dt_s,
        present: fine.present.chunks_exact(m).map(|c| c.iter().all(|p| *p)).collect(),
        gaps: fine.gaps.clone(),
        averaged: fine.averaged * m,
        disordered: fine.disordered,
    };
    Regular { grid, rate: means(&regular.rate), columns }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_expected_on_a_turning_table_leaves_nothing_in_averages() {
        let angles: Vec<f64> = (0..400).map(|i| (37.0 * f64::from(i)).rem_euclid(360.0)).collect();
        let expected = |r: &Regular| -> Vec<f64> {
            r.columns[&Column::TableAngle].iter().map(|a| 13.0 * a.to_radians().cos()).collect()
        };
        let mut regular = Regular {
            grid: Grid {
                dt_s: 2.0,
                start_s: 0.0,
                present: vec![true; 400],
                gaps: vec![],
                averaged: 1,
                disordered: 0,
            },
            rate: vec![],
            columns: std::collections::BTreeMap::from([(Column::TableAngle, angles)]),
        };
        regular.rate = expected(&regular);
        let out = about_the_claim(&regular, 4, expected);
        for (rate, expected) in out.rate.iter().zip(expected(&out)) {
            assert!((rate - expected).abs() < 1e-9, "{rate} {expected}");
        }
        assert_eq!(out.rate.len(), 100);
    }

    #[test]
    fn missing_rows_stay_where_they_were_recorded() {
        let mut present = vec![true; 400];
        present[10..13].fill(false);
        let grid = Grid { dt_s: 0.5, start_s: 3.0, present, gaps: vec![(10, 3)], averaged: 1, disordered: 0 };
        let regular = Regular { grid, rate: vec![0.0; 400], columns: Default::default() };
        let out = averaged(&regular, 4).grid;
        // Places 2 and 3 hold samples 8 to 15; in time the first missing row is at 8 s, as before.
        assert_eq!(out.places_in_gaps(), [2, 3]);
        assert_eq!((out.rows(&[]).time_s(10), regular.rows().time_s(10)), (8.0, 8.0));
        assert_eq!(out.missing(), 3);
    }
}
