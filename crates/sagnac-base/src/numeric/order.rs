//! Values in their order.

use std::cmp::Ordering;

/// Median of the absolute values of a normal law over its deviation.
pub const NORMAL_MEDIAN: f64 = 0.674_489_750_196_082;

/// Stable sorting by a number. Numbers alone are sorted, whatever they belong to, so that the sort is compiled once and not
/// for every type and key.
pub trait SortByNumber<T> {
    /// Sorts by `key`, the smallest first; equal keys keep their order.
    fn sort_ascending_by(&mut self, key: impl Fn(&T) -> f64);
    /// Sorts by `key`, the largest first; equal keys keep their order.
    fn sort_descending_by(&mut self, key: impl Fn(&T) -> f64);
}

impl<T> SortByNumber<T> for [T] {
    fn sort_ascending_by(&mut self, key: impl Fn(&T) -> f64) {
        let keys: Vec<f64> = self.iter().map(key).collect();
        permute(self, places(keys, f64::total_cmp));
    }

    fn sort_descending_by(&mut self, key: impl Fn(&T) -> f64) {
        let keys: Vec<f64> = self.iter().map(key).collect();
        permute(self, places(keys, |a, b| b.total_cmp(a)));
    }
}

/// Stable sorting of numbers.
pub trait SortNumbers {
    /// Sorts the numbers, the smallest first.
    fn sort_ascending(&mut self);
}

impl SortNumbers for [f64] {
    fn sort_ascending(&mut self) {
        self.sort_by(f64::total_cmp);
    }
}

/// The place of each key once they are sorted.
fn places(keys: Vec<f64>, compare: fn(&f64, &f64) -> Ordering) -> Vec<usize> {
    let mut sorted: Vec<(f64, usize)> = keys.into_iter().zip(0..).collect();
    sorted.sort_by(|a, b| compare(&a.0, &b.0));
    let mut places = vec![0; sorted.len()];
    for (place, (_, from)) in sorted.into_iter().enumerate() {
        places[from] = place;
    }
    places
}

/// Brings each item to its place.
fn permute<T>(items: &mut [T], mut places: Vec<usize>) {
    for i in 0..places.len() {
        while places[i] != i {
            let place = places[i];
            items.swap(i, place);
            places.swap(i, place);
        }
    }
}

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
    fn sorting_by_a_number_keeps_the_order_of_equal_ones() {
        let mut items = [(3.0, 'a'), (1.0, 'b'), (3.0, 'c'), (-0.0, 'd'), (f64::NAN, 'e'), (0.0, 'f')];
        items.sort_ascending_by(|i| i.0);
        assert_eq!(items.map(|i| i.1), ['d', 'f', 'b', 'a', 'c', 'e']);
        items.sort_descending_by(|i| i.0);
        assert_eq!(items.map(|i| i.1), ['e', 'a', 'c', 'b', 'f', 'd']);
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
