//! The size at which a growing quantity reaches a value.

/// Factor by which a size is changed while nothing is known of it but that it is too small or too large.
const BRACKET_FACTOR: f64 = 8.0;
/// Evaluations until the size is between two others.
const MAX_BRACKET_EVALUATIONS: usize = 24;
/// Evaluations between them.
const MAX_BISECTIONS: usize = 12;
/// Relative difference of the quantity that is near enough.
const SOLUTION_TOLERANCE: f64 = 0.01;

/// The size at which `of`, which grows about with the square of the size, is `wanted`. `None` where it does not reach
/// that within sizes up to `largest`.
pub(super) fn size(begin: f64, largest: f64, wanted: f64, of: impl Fn(f64) -> f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut at = begin.min(largest);
    for _ in 0..MAX_BRACKET_EVALUATIONS + MAX_BISECTIONS {
        let value = of(at);
        if !value.is_finite() {
            return None;
        }
        if (value / wanted - 1.0).abs() < SOLUTION_TOLERANCE || high / low < 1.0 + 0.5 * SOLUTION_TOLERANCE {
            return Some(at);
        }
        if value < wanted {
            if at >= largest {
                return None;
            }
            low = at;
        } else {
            high = at;
        }
        let square = if value > 0.0 { at * (wanted / value).sqrt() } else { BRACKET_FACTOR * at };
        at = match (low > 0.0, high.is_finite()) {
            (true, true) if square > low && square < high => square,
            (true, true) => (low * high).sqrt(),
            (true, false) => square.clamp(1.05 * low, 1e4 * low),
            _ => square.clamp(1e-6 * high, high / 1.05),
        }
        .min(largest);
    }
    high.is_finite().then_some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_solved_at_once_and_what_bends_or_jumps_in_some_steps() {
        let root = size(1.0, 1e9, 50.0, |x| 2.0 * x * x).unwrap();
        assert!((root - 5.0).abs() < 0.03, "{root}");
        let saturating = size(1e-3, 1e9, 30.0, |x| 100.0 * x * x / (1.0 + x * x)).unwrap();
        assert!((saturating - (30.0f64 / 70.0).sqrt()).abs() < 0.01, "{saturating}");
        // Nothing up to 7, a lot from there on.
        let jump = size(0.01, 1e9, 30.0, |x| if x < 7.0 { 0.0 } else { 1e4 * x }).unwrap();
        assert!((jump / 7.0 - 1.0).abs() < 0.02, "{jump}");
        assert_eq!(size(1.0, 1e9, 200.0, |x| 100.0 * x * x / (1.0 + x * x)), None);
        assert_eq!(size(1.0, 10.0, 50.0, |x| 0.1 * x * x), None);
    }
}
