//! The local search of the parameters that a mean model is not linear in.

use crate::effect::{Drivers, MeanModel};
use crate::numeric::optimize::pattern_search;
use crate::numeric::range::Bounds;

/// Loss of log-likelihood by steps to either side from which smaller steps are taken: what is left lies within a
/// hundredth of a standard deviation then.
const MIN_STEP_LOSS: f64 = 1e-4;

/// Bounds and steps of a search of the nonlinear parameters of a mean model.
pub struct LocalSearch {
    bounds: Vec<Bounds>,
    /// First steps: 0 for a whole number, which is tried and not refined; `None`: by the bounds.
    steps: Vec<Option<f64>>,
    free: usize,
}

impl LocalSearch {
    /// That of a model on given columns.
    pub fn of(model: &dyn MeanModel, drivers: &Drivers) -> LocalSearch {
        let (bounds, steps) = (model.bounds(drivers), model.steps(drivers));
        let is_whole = |i: &usize| model.whole().contains(i);
        let free = (0..bounds.len()).filter(|i| bounds[*i].width() > 0.0 && !is_whole(i)).count();
        let first = |i: usize| if is_whole(&i) { Some(0.0) } else { steps.get(i).copied() };
        LocalSearch { steps: (0..bounds.len()).map(first).collect(), bounds, free }
    }

    /// Parameters that are searched over. A whole number has few values: it counts in the p-value alone.
    pub fn free(&self) -> usize {
        self.free
    }

    /// The nonlinear parameters reached from a start, and their gain, in so many evaluations of it at most.
    pub fn refine(&self, start: &[f64], evaluations: usize, gain: impl Fn(&[f64]) -> f64) -> (Vec<f64>, f64) {
        pattern_search(start, &self.bounds, &self.steps, (evaluations, MIN_STEP_LOSS), gain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Model, find};

    #[test]
    fn a_whole_number_is_no_parameter_that_is_searched_over() {
        let rate: Vec<f64> = (0..100).map(|i| f64::from(i) / 50.0 - 1.0).collect();
        let drivers = Drivers { dt_s: 1.0, samples: 100, table_rate: Some(rate), ..Drivers::default() };
        let of = |kind: &str| {
            let Model::Mean(model) = find(kind).unwrap().model() else { panic!("no mean model") };
            LocalSearch::of(model, &drivers)
        };
        // A dead zone has a width, and a form that is one of two.
        let zone = of("dead_zone");
        assert_eq!((zone.free(), zone.steps.len(), zone.steps[1]), (1, 2, Some(0.0)));
        let (at, _) = zone.refine(&[100.0, 1.0], 200, |x| -(x[0].ln() - 6.0).powi(2) - x[1]);
        assert!((at[0].ln() - 6.0).abs() < 0.02 && at[1] == 1.0, "{at:?}");
        assert_eq!(of("sf_error").free(), 0);
        // A day is known where a record is shorter than two.
        assert_eq!(of("diurnal").free(), 0);
    }
}
