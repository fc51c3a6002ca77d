//! Differences of stamps, and how far stamps depart from a straight line.

/// A row and the stamp on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StampedRow {
    /// Number of the row.
    pub row: f64,
    /// Its stamp, s.
    pub stamp: f64,
}

/// The step from each stamp to the next.
pub(super) fn steps(t: &[f64]) -> impl Iterator<Item = f64> {
    t.iter().zip(t.get(1..).unwrap_or_default()).map(|(a, b)| b - a)
}

/// Range of the departures of values from the straight line through them.
pub(super) fn departure(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let (mx, my) = ((n - 1.0) / 2.0, values.iter().sum::<f64>() / n);
    let (mut xx, mut xy) = (0.0, 0.0);
    for (i, v) in values.iter().enumerate() {
        let x = i as f64 - mx;
        xx += x * x;
        xy += x * (v - my);
    }
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    let off = values.iter().enumerate().map(|(i, v)| v - my - slope * (i as f64 - mx));
    let (low, high) = off.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
    high - low
}
