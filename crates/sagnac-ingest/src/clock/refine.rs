//! The interval of a probed clock, measured by following the stamps it was found from.

use super::nominal::{Clock, tidy};
use super::tracker::{Step, Tracker};

/// Follows the probed stamps with a clock and measures its interval; twice, for a better start.
pub(super) fn refined(mut clock: Clock, t: &[f64]) -> Clock {
    for _ in 0..2 {
        let mut tracker = Tracker::new(clock);
        let mut head: Vec<f64> = Vec::new();
        let mut samples = 0.0;
        for (i, &stamp) in t.iter().enumerate() {
            match tracker.step(stamp, t.get(i + 1).copied()) {
                Step::Next => {}
                Step::Gap { missing, .. } => samples += missing as f64,
                _ => continue,
            }
            if head.len() < 256 && (i == 0 || tracker.compared()) {
                head.push(stamp - samples * clock.interval_s);
            }
            samples += 1.0;
        }
        let interval_s = tracker.mean_interval_s();
        if !(interval_s.is_normal() && (interval_s / clock.interval_s - 1.0).abs() < 0.2) {
            break;
        }
        // The mean course through the first stamps, as far as the interval is known.
        let first = head.first().copied().unwrap_or(0.0);
        let residual_s = mean(head.iter().map(|h| first - h)).unwrap_or(0.0);
        // Whole intervals are samples miscounted on the way to the course, no departure of the first stamp.
        clock.first_residual_s = residual_s - (residual_s / interval_s).round() * interval_s;
        clock.gap_limit_s *= interval_s / clock.interval_s;
        clock.interval_s = tidy(whole_steps(interval_s, clock.resolution_s));
    }
    clock
}

/// The mean; `None` without values.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0u64), |(s, n), v| (s + v, n + 1));
    (count > 0).then(|| sum / count as f64)
}

/// A whole number of the steps that the stamps are rounded to, where the interval is one within 1e-4: a row too many or
/// too few among coarse stamps shifts their mean by less.
pub(super) fn whole_steps(interval_s: f64, resolution_s: f64) -> f64 {
    let steps = interval_s / resolution_s;
    if resolution_s > 0.0 && (steps / steps.round() - 1.0).abs() < 1e-4 {
        steps.round() * resolution_s
    } else {
        interval_s
    }
}
