//! Straight lines between claimed points.

use crate::effect::{Knot, Value};

/// Times in rising order with a value each.
pub(in crate::effect) struct Knots<'a> {
    times: &'a [f64],
    values: &'a [f64],
}

impl<'a> Knots<'a> {
    /// `None` for lists that are empty, of different lengths, not finite or not rising.
    pub(in crate::effect) fn new(times: &'a [f64], values: &'a [f64]) -> Option<Knots<'a>> {
        let whole = !times.is_empty() && times.len() == values.len();
        let finite = times.iter().chain(values).all(|x| x.is_finite());
        let rising = times.windows(2).all(|w| w[0] < w[1]);
        (whole && finite && rising).then_some(Knots { times, values })
    }

    /// Value at a time; that of the nearest end outside.
    pub(in crate::effect) fn at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|t| *t <= time);
        match (after.checked_sub(1), self.times.get(after)) {
            (None, _) => self.values[0],
            (Some(i), None) => self.values[i],
            (Some(i), Some(next)) => {
                let x = (time - self.times[i]) / (next - self.times[i]);
                self.values[i] + (self.values[after] - self.values[i]) * x
            }
        }
    }
}

/// Values by which a claim states knots: the lists of their places and of their values, under the given names.
pub(in crate::effect) fn values_of_knots(knots: &[Knot], places: &str, values: &str) -> [(String, Value); 2] {
    let list = |part: fn(&Knot) -> f64| Value::List(knots.iter().map(part).collect());
    [(places.to_owned(), list(|k| k.at)), (values.to_owned(), list(|k| k.value))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_run_between_knots_and_stop_at_the_ends() {
        let knots = Knots::new(&[0.0, 10.0, 20.0], &[1.0, 3.0, -1.0]).unwrap();
        for (time, value) in [(-5.0, 1.0), (0.0, 1.0), (5.0, 2.0), (10.0, 3.0), (15.0, 1.0), (99.0, -1.0)] {
            assert!((knots.at(time) - value).abs() < 1e-12, "{time}");
        }
        assert!(Knots::new(&[], &[]).is_none() && Knots::new(&[1.0, 1.0], &[0.0, 0.0]).is_none());
        assert!(Knots::new(&[1.0], &[f64::NAN]).is_none() && Knots::new(&[1.0], &[]).is_none());
    }
}
