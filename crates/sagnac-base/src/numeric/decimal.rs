//! Decimal digits that values were written with.

/// True where every value is a whole multiple of a unit, within what a double rounds of such values; false where they hold too
/// many units to tell.
pub fn multiples<'a>(mut values: impl Iterator<Item = &'a f64> + Clone, unit: f64) -> bool {
    let largest = values.clone().fold(0.0f64, |m, v| m.max(v.abs()));
    let allowed = 1e-6 + 4.0 * f64::EPSILON * largest / unit;
    allowed < 0.1 && values.all(|v| (v / unit - (v / unit).round()).abs() <= allowed)
}

#[cfg(test)]
mod tests {
    use super::multiples;

    #[test]
    fn values_are_multiples_of_the_digit_they_are_written_with_and_not_of_a_larger_one() {
        let values = [1e6 + 0.25, -0.75, 12.5];
        assert!(multiples(values.iter(), 0.05) && !multiples(values.iter(), 0.1));
    }

    #[test]
    fn beyond_what_a_double_holds_nothing_is_told() {
        assert!(!multiples([1e16].iter(), 1.0));
    }
}
