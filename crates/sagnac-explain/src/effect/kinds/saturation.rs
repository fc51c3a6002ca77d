//! A response that is limited at large rates.

use crate::effect::mean::first;
use crate::effect::shared::reach::{largest_rate, varies};
use crate::effect::shared::search::{best_of, log_grid, shortlist};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, number,
};
use crate::numeric::range::{Bounds, ends};

pub struct Saturation;

static PARAMS: [Param; 1] = [Param::reported("limit_deg_s", "deg/s", 1e-9, 1e6)];

describe! {
    Saturation, "saturation", Mean in InputRate, needs [TableRate],
    confusers [SfNonlinearity, SfError]
}

fn beyond(limit: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let rate = drivers.table_rate.as_ref()?;
    (limit > 0.0).then(|| rate.iter().map(|r| -3600.0 * r.signum() * (r.abs() - limit).max(0.0)).collect())
}

impl MeanModel for Saturation {
    fn applies(&self, drivers: &Drivers) -> bool {
        varies(drivers.table_rate.as_deref()) && largest_rate(drivers) > 0.0
    }

    /// Limits that fall short of the largest rate by shares from a billionth, which is what the best units resolve, to three quarters.
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let most = largest_rate(drivers);
        let shares = log_grid(1e-9, 0.75, 60);
        let limits = shares.into_iter().map(|s| vec![most * (1.0 - s)]);
        let limits = shortlist(self, limits, 6, drivers, context);
        let points = best_of(self, limits, 3, drivers, context);
        Starts { points, trials: 10.0 }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let most = largest_rate(drivers).max(1e-12);
        vec![Bounds::new(0.2 * most, most)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors {
            offset: nonlinear_parameters.first().and_then(|l| beyond(*l, drivers)),
            ..Regressors::default()
        }
    }

    fn parameters(
        &self,
        nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<f64> {
        vec![first(nonlinear_parameters)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        beyond(number(values, PARAMS[0].name)?, drivers)
    }

    /// A unit has one limit.
    fn same_cause(&self, _earlier: &[f64], _nonlinear_parameters: &[f64]) -> bool {
        true
    }

    /// The rates beyond the limit, those of the sign of which more is cut off.
    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let (Some(limit), Some(rate)) = (nonlinear_parameters.first(), &drivers.table_rate) else {
            return vec![];
        };
        let Bounds { low, high } = ends(rate);
        let cut = |sign: f64| rate.iter().map(|r| (sign * r - limit).max(0.0)).sum::<f64>();
        let (down, up) = (cut(-1.0), cut(1.0));
        if down.max(up) <= 0.0 {
            return vec![];
        }
        let (from, to) = if up >= down { (*limit, high) } else { (low, -limit) };
        vec![Place { domain: Domain::InputRate, from, to }]
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        vec![1e-3 * largest_rate(drivers)]
    }

    fn distance_from_corner(&self, parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        let (limit, rate) = (parameters.first()?, drivers.table_rate.as_ref()?);
        Some(rate.iter().map(|r| r.abs() - limit).collect())
    }

    /// Samples in which the rate passes the limit on its way from one neighbour to the other: how long it was beyond within the sample,
    /// its mean does not say. None where too few samples lie beyond altogether to do without them.
    fn curvature_within_average(&self, parameters: &[f64], drivers: &Drivers) -> Vec<usize> {
        let (Some(limit), Some(rate)) = (parameters.first(), &drivers.table_rate) else { return vec![] };
        let passes = |i: &usize| {
            let around = &rate[i.saturating_sub(1)..(i + 2).min(rate.len())];
            let Bounds { low, high } = ends(around);
            (low < *limit && *limit < high) || (low < -*limit && -*limit < high)
        };
        let bent: Vec<usize> = (0..rate.len()).filter(passes).collect();
        let beyond = rate.iter().filter(|r| r.abs() > *limit).count();
        if 3 * bent.len() > beyond { vec![] } else { bent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_just_below_the_largest_rate_is_among_the_starts() {
        use crate::numeric::cosine::dct2;
        let n = 4000;
        let rate: Vec<f64> = (0..n).map(|i| f64::from(i / 500 % 4) * 5.0 - 7.5).collect();
        let drivers = Drivers {
            dt_s: 1.0,
            samples: n as usize,
            averaged: 1,
            table_rate: Some(rate),
            ..Drivers::default()
        };
        // 2.7 mdeg/h of 7.5 deg/s: a tenth of a millionth.
        let limit = 7.5 * (1.0 - 1e-7);
        let residual = beyond(limit, &drivers).unwrap();
        let power = 1e-8;
        let score: Vec<f64> = residual.iter().map(|r| r / power).collect();
        let (modes, powers) = (dct2(&residual), vec![power; n as usize]);
        let context = SearchContext { score: &score, modes: &modes, powers: &powers };
        let best = Saturation.starts(&drivers, &context).points[0][0];
        assert!(((7.5 - best) / 7.5e-7 - 1.0).abs() < 0.3, "{best}");
    }

    #[test]
    fn samples_in_which_the_rate_passes_the_limit_are_told() {
        let told = |mut rate: Vec<f64>, limit: f64| {
            rate.extend([5.0; 20]);
            let samples = rate.len();
            let drivers = Drivers { dt_s: 1.0, samples, table_rate: Some(rate), ..Drivers::default() };
            Saturation.curvature_within_average(&[limit], &drivers)
        };
        let steps = vec![0.0, 2.0, 4.0, 5.0, 5.0, 5.0, 3.0, -3.0, -5.0, -5.0, -5.0];
        let drivers = Drivers { table_rate: Some(vec![-4.0, 5.0]), ..Drivers::default() };
        assert_eq!(Saturation.distance_from_corner(&[4.5], &drivers), Some(vec![-0.5, 0.5]));
        assert_eq!(told(steps.clone(), 4.5), [2, 3, 5, 6, 7, 8, 10, 11]);
        assert!(told(steps, 6.0).is_empty());
        let tops = [0.0, 5.0].repeat(40);
        assert!(told(tops, 4.5).is_empty());
    }
}
