//! Where something changes, and where something is least, between two values.

/// Halves the span between a value where something holds and one where it does not, so many times: the span that is left.
pub fn halved(mut inside: f64, mut outside: f64, times: usize, holds: impl Fn(f64) -> bool) -> (f64, f64) {
    for _ in 0..times {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        if holds(middle) { inside = middle } else { outside = middle }
    }
    (inside, outside)
}

/// The place of the one minimum of a function between two values, by so many golden sections.
pub fn least(mut low: f64, mut high: f64, times: usize, of: impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_895;
    for _ in 0..times {
        let (a, b) = (high - RATIO * (high - low), low + RATIO * (high - low));
        if of(a) < of(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_span_that_is_left_holds_the_root() {
        let (inside, outside) = halved(1.0, 2.0, 50, |x| x * x < 2.0);
        assert!(inside * inside < 2.0 && outside * outside >= 2.0 && outside - inside < 1e-14);
        let (inside, outside) = halved(2.0, 1.0, 200, |x| x * x > 2.0);
        assert!(inside > outside && inside * inside > 2.0, "{inside} {outside}");
    }

    #[test]
    fn the_minimum_of_a_parabola_is_found() {
        assert!((least(-1.0, 4.0, 60, |x| (x - 0.7).powi(2)) - 0.7).abs() < 1e-7);
    }
}
