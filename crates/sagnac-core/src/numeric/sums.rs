//! Running sums.

/// Running sums of values, beginning with 0: one more than there are values, so that the sum of values `a..b` is the
/// difference of sums `b` and `a`.
pub(crate) fn cumulated(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    std::iter::once(0.0)
        .chain(values.map(|v| {
            sum += v;
            sum
        }))
        .collect()
}
