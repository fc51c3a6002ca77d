//! Searches along one variable: bisection, golden sections, and the peak of a parabola through three points.

/// Bisection: halves the span between `inside`, where `holds` is true, and `outside`, where it is false, `times` times or
/// until no number lies between. Gives the ends of the span that is left, in the same order.
pub fn bisect(mut inside: f64, mut outside: f64, times: usize, holds: impl Fn(f64) -> bool) -> (f64, f64) {
    for _ in 0..times {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        if holds(middle) { inside = middle } else { outside = middle }
    }
    (inside, outside)
}

/// The argument of the minimum of a function with a single minimum between `low` and `high`, by `times` golden sections
/// (Kiefer 1953): each leaves 0.618 of the span.
pub fn golden_section(mut low: f64, mut high: f64, times: usize, of: impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_895;
    for _ in 0..times {
        let (a, b) = (high - RATIO * (high - low), low + RATIO * (high - low));
        if of(a) < of(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// Position of the peak of the parabola through `values[at]` and its two neighbours, in grid steps from `at`, between −0.5
/// and 0.5. 0 where a neighbour is missing or the three points do not bend downwards.
pub fn parabolic_peak(values: &[f64], at: usize) -> f64 {
    let (Some(here), Some(after)) = (values.get(at), values.get(at + 1)) else { return 0.0 };
    let Some(before) = at.checked_sub(1).and_then(|i| values.get(i)) else { return 0.0 };
    let curve = before + after - 2.0 * here;
    if curve < 0.0 { (0.5 * (before - after) / curve).clamp(-0.5, 0.5) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_span_that_is_left_holds_the_root() {
        let (inside, outside) = bisect(1.0, 2.0, 50, |x| x * x < 2.0);
        assert!(inside * inside < 2.0 && outside * outside >= 2.0 && outside - inside < 1e-14);
        let (inside, outside) = bisect(2.0, 1.0, 200, |x| x * x > 2.0);
        assert!(inside > outside && inside * inside > 2.0, "{inside} {outside}");
    }

    #[test]
    fn the_minimum_of_a_parabola_is_found() {
        assert!((golden_section(-1.0, 4.0, 60, |x| (x - 0.7).powi(2)) - 0.7).abs() < 1e-7);
    }
}
