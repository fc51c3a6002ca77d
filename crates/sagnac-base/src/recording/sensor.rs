//! Resolution and noise of the sensor behind a recorded quantity, such as a thermometer, and the quantity freed of them.
//!
//! A fit takes what it is given as the truth. A thermometer of whole degrees is off by up to half a degree, in step with the
//! temperature itself, and a fit explains that by lags and loops that are not there; the noise of a thermometer at constant
//! temperature is a range of temperature that is not there. So every quantity that a model is driven by passes through here.
//!
//! - **Coarse steps.** Between two steps the reading tells nothing, but when it changes the quantity is half way between them:
//!   known to a sample, far better than the step. The course runs straight from one such crossing to the next. Where it turns
//!   back within a step it goes on as steep as it came, to the middle of the step at most.
//! - **Noise.** Neighbouring values tell the white noise. A quantity whose means over long stretches scatter by no more than
//!   that noise does not move.

use crate::estimate::chi_square_tail;
use crate::numeric::order::SortNumbers;

/// Share of the range of a quantity from which its steps are coarse. Finer ones are smaller than what a fit resolves.
const MIN_STEP_SHARE: f64 = 0.005;
/// Share of the values that must repeat the one before: a reading that noise carries over its steps is not coarse.
const MIN_REPEATED: f64 = 0.7;
/// Difference from a whole number of steps, in steps, by which a value is not on the grid.
const OFF_GRID: f64 = 1e-3;
/// Share of the values that must be on the grid; the others are means over a change.
const MIN_ON_GRID: f64 = 0.8;
/// Longest time before the first crossing, and in a step that is not passed through, that is taken for movement: a share of it.
const TURN_SHARE: f64 = 0.25;
/// Stretches whose means are set against the noise.
const STRETCH_COUNT: usize = 24;
/// Values in a stretch at least.
const MIN_IN_STRETCH: usize = 8;
/// Probability by chance below which means of stretches scatter by more than noise.
const MOTION_SIGNIFICANCE: f64 = 1e-3;

/// The step of readings on a grid that is coarse against their range; `None` where there is none.
pub fn coarse_step(values: &[f64]) -> Option<f64> {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let count = finite().count();
    let pairs = || values.iter().zip(values.iter().skip(1)).filter(|(a, b)| a.is_finite() && b.is_finite());
    let repeated = pairs().filter(|(a, b)| a == b).count();
    if count < 8 || (repeated as f64) < MIN_REPEATED * pairs().count() as f64 {
        return None;
    }
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    // Values that stay are readings; those that do not may be means over a change.
    let mut levels: Vec<f64> = pairs().filter(|(a, b)| a == b).map(|(a, _)| *a).collect();
    levels.sort_ascending();
    levels.dedup();
    let gaps = levels.iter().zip(levels.iter().skip(1)).map(|(a, b)| b - a);
    let step = gaps.reduce(f64::min).filter(|step| *step > MIN_STEP_SHARE * (high - low))?;
    let origin = *levels.first()?;
    let on_grid = |v: &f64| {
        let at = (v - origin) / step;
        (at - at.round()).abs() < OFF_GRID
    };
    let all_levels = levels.iter().all(&on_grid);
    let known = finite().filter(|v| on_grid(v)).count();
    (all_levels && known as f64 >= MIN_ON_GRID * count as f64).then_some(step)
}

/// The course behind readings on a coarse grid, at straight lines between the crossings of its steps; `None` for any other
/// readings, and where none of the steps was crossed. No value may be missing.
pub fn between_steps(values: &[f64]) -> Option<Vec<f64>> {
    let step = coarse_step(values)?;
    let mut crossings: Vec<(f64, f64)> = vec![];
    let (mut at, mut held) = (0, *values.first()?);
    for (i, v) in values.iter().enumerate() {
        // A mean over a change belongs to neither side.
        let stays = values.get(i + 1) == Some(v) || i.checked_sub(1).and_then(|b| values.get(b)) == Some(v);
        if !stays {
            continue;
        }
        if *v != held {
            crossings.push((0.5 * (at + i) as f64, 0.5 * (held + v)));
        }
        (at, held) = (i, *v);
    }
    let (first, last) = (*crossings.first()?, *crossings.last()?);
    let slope = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0).max(1.0);
    let (opening, closing) = match (crossings.get(1), crossings.len().checked_sub(2)) {
        (Some(second), Some(before)) => (slope(first, *second), slope(crossings[before], last)),
        _ => (0.0, 0.0),
    };
    // From a crossing into a step that is not passed through: as steep as on its other side, to the middle of the step.
    let into = |from: (f64, f64), reading: f64, steepness: f64, time: f64, length: f64| {
        let least = 0.5 * step / (TURN_SHARE * length).max(1.0);
        let way = (steepness.abs().max(least) * time).min(0.5 * step);
        from.1 + way.copysign(reading - from.1)
    };
    let n = values.len();
    let mut out = Vec::with_capacity(n);
    let mut next = 0;
    for (i, v) in values.iter().enumerate() {
        let t = i as f64;
        while crossings.get(next).is_some_and(|c| c.0 <= t) {
            next += 1;
        }
        let before = next.checked_sub(1).map(|b| crossings[b]);
        out.push(match (before, crossings.get(next).copied()) {
            (None, Some(b)) => into(b, values[0], opening, b.0 - t, b.0),
            (Some(a), None) => into(a, values[n - 1], closing, t - a.0, n as f64 - a.0),
            (Some(a), Some(b)) if a.1 == b.1 => {
                let reading = values.get((0.5 * (a.0 + b.0)).round() as usize).copied().unwrap_or(*v);
                let steepness = |k: usize, j: usize| match (crossings.get(k), crossings.get(j)) {
                    (Some(x), Some(y)) => slope(*x, *y),
                    _ => 0.0,
                };
                let came = next.checked_sub(2).map_or(0.0, |k| steepness(k, k + 1));
                let goes = steepness(next, next + 1);
                let (rise, fall) =
                    (into(a, reading, came, t - a.0, b.0 - a.0), into(b, reading, goes, b.0 - t, b.0 - a.0));
                if (rise - a.1).abs() < (fall - a.1).abs() { rise } else { fall }
            }
            (Some(a), Some(b)) => a.1 + slope(a, b) * (t - a.0),
            (None, None) => *v,
        });
    }
    Some(out)
}

/// True where a quantity does not move: the means over long stretches scatter by no more than the white noise that
/// neighbouring values show. Missing values are NaN.
pub fn is_steady(values: &[f64]) -> bool {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let length = finite.len() / STRETCH_COUNT;
    if length < MIN_IN_STRETCH {
        return false;
    }
    let changes = finite.iter().zip(finite.iter().skip(1)).map(|(a, b)| (b - a).powi(2)).sum::<f64>();
    let white = 0.5 * changes / (finite.len() - 1) as f64;
    if white <= 0.0 {
        return finite.iter().all(|v| Some(v) == finite.first());
    }
    let means: Vec<f64> =
        finite.chunks_exact(length).map(|c| c.iter().sum::<f64>() / length as f64).collect();
    let middle = means.iter().sum::<f64>() / means.len() as f64;
    let square: f64 = means.iter().map(|m| (m - middle).powi(2)).sum();
    chi_square_tail(square * length as f64 / white, (means.len() - 1) as f64) > MOTION_SIGNIFICANCE
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up by 45 in `ramp` samples, a stay, and down again, twice.
    fn sweep(ramp: usize) -> Vec<f64> {
        let up: Vec<f64> = (0..ramp).map(|i| 5.0 + 45.0 * i as f64 / ramp as f64).collect();
        let down: Vec<f64> = up.iter().rev().copied().collect();
        let one = [vec![5.0; 200], up, vec![50.0; 200], down].concat();
        [one.clone(), one, vec![5.0; 100]].concat()
    }

    #[test]
    fn whole_degrees_give_the_course_back_to_a_tenth_of_them() {
        for ramp in [540, 1100] {
            let truth = sweep(ramp);
            let read: Vec<f64> = truth.iter().map(|t| t.round()).collect();
            assert_eq!(coarse_step(&read), Some(1.0));
            let course = between_steps(&read).unwrap();
            let most = course.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(most < 0.1, "{ramp}: {most}");
            // Means of two samples hold values between the steps.
            let pairs = |v: &[f64]| v.chunks_exact(2).map(|c| 0.5 * (c[0] + c[1])).collect::<Vec<_>>();
            let (course, truth) = (between_steps(&pairs(&read)).unwrap(), pairs(&truth));
            let most = course.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(most < 0.15, "{ramp}: {most}");
        }
    }

    #[test]
    fn fine_steps_and_noisy_readings_are_left_alone() {
        let truth = sweep(540);
        let fine: Vec<f64> = truth.iter().map(|t| (t * 100.0).round() / 100.0).collect();
        assert_eq!(between_steps(&fine), None);
        let noisy: Vec<f64> = truth
            .iter()
            .enumerate()
            .map(|(i, t)| (t + ((i * 7919 % 97) as f64 / 48.0 - 1.0)).round())
            .collect();
        assert_eq!(between_steps(&noisy), None);
        assert_eq!(between_steps(&[20.0; 50]), None);
        assert_eq!(between_steps(&[]), None);
    }

    #[test]
    fn noise_alone_does_not_move_and_a_drift_within_it_does() {
        let noise = |i: usize| (i * 7919 % 9973) as f64 / 9973.0 - 0.5;
        let still: Vec<f64> = (0..9600).map(|i| 24.0 + 0.07 * noise(i)).collect();
        assert!(is_steady(&still));
        let drift: Vec<f64> = still.iter().enumerate().map(|(i, v)| v + 0.02 * i as f64 / 9600.0).collect();
        assert!(!is_steady(&drift));
        assert!(is_steady(&[20.0; 500]) && !is_steady(&still[..100]));
    }
}
