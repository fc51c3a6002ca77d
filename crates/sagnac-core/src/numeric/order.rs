//! Values in their order.

/// Median of the absolute values of a normal law over its deviation.
pub const NORMAL_MEDIAN: f64 = 0.674_489_750_196_082;

/// The median, the upper of the two in the middle of an even number of values; 0 for none. Reorders the values.
pub fn upper_median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// A quantile of ascending values, between two neighbours in proportion (type 7 of Hyndman and Fan 1996); `None` for no values.
pub fn quantile(ascending: &[f64], share: f64) -> Option<f64> {
    let place = share * (ascending.len().checked_sub(1)? as f64);
    let (below, above) = (place.floor(), place.ceil());
    let (low, high) = (*ascending.get(below as usize)?, *ascending.get(above as usize)?);
    Some(low + (place - below) * (high - low))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_upper_of_the_two_in_the_middle_is_the_median() {
        assert_eq!(upper_median(&mut [5.0, -1.0, 3.0]), 3.0);
        assert_eq!(upper_median(&mut [4.0, 1.0, 3.0, 2.0]), 3.0);
        assert_eq!(upper_median(&mut []), 0.0);
    }

    #[test]
    fn quantiles_lie_between_neighbours() {
        let values = [1.0, 2.0, 3.0, 5.0];
        assert_eq!(quantile(&values, 0.5), Some(2.5));
        assert_eq!(quantile(&values, 0.0), Some(1.0));
        assert_eq!(quantile(&values, 1.0), Some(5.0));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
