//! Values of a column at which an effect acts, and columns that vary.

use super::table_angle::visited;
use super::thermal::{rate, smooth};
use crate::effect::{Domain, Drivers, Place};
use crate::numeric::range::{Bounds, ends};

/// The values of a column at which a contribution departs from its mean by half of its largest departure or more.
pub(in crate::effect) fn reach(domain: Domain, column: &[f64], contribution: &[f64]) -> Vec<Place> {
    if column.is_empty() || contribution.is_empty() {
        return vec![];
    }
    let mean = contribution.iter().sum::<f64>() / contribution.len() as f64;
    let largest = contribution.iter().map(|c| (c - mean).abs()).fold(0.0, f64::max);
    let acts = column.iter().zip(contribution).filter(|(_, c)| (**c - mean).abs() >= 0.5 * largest);
    let (from, to) = acts.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (x, _)| (a.min(*x), b.max(*x)));
    if from <= to { vec![Place { domain, from, to }] } else { vec![] }
}

/// Intervals in which the quantity of a domain is far from its mean, or acts at all: where an effect shows that follows it.
pub(in crate::effect) fn places_of(domain: Domain, drivers: &Drivers) -> Vec<Place> {
    let of_values = |values: Option<&[f64]>| values.map_or_else(Vec::new, |v| reach(domain, v, v));
    match domain {
        Domain::Time => record(drivers),
        Domain::Angle => visited(drivers),
        Domain::InputRate => large_rates(drivers),
        Domain::OuterRate => of_values(drivers.outer_rate.as_deref()),
        Domain::Supply => of_values(drivers.supply.as_deref()),
        Domain::Temperature => of_values(smooth(drivers)),
        Domain::TemperatureRate => of_values(rate(drivers).as_deref()),
        Domain::Frequency | Domain::Lag | Domain::Amplitude | Domain::Timestamps | Domain::Driver => vec![],
    }
}

/// Largest size of the rate of the table, deg/s; 0 without a table.
pub(in crate::effect) fn largest_rate(drivers: &Drivers) -> f64 {
    drivers.table_rate.iter().flatten().map(|r| r.abs()).fold(0.0, f64::max)
}

/// Rates at which an effect that grows with the rate is at least half of its largest.
pub(in crate::effect) fn large_rates(drivers: &Drivers) -> Vec<Place> {
    let Some(rate) = &drivers.table_rate else { return vec![] };
    let Bounds { low: from, high: to } = ends(rate);
    let largest = from.abs().max(to.abs());
    let Bounds { low: from, high: to } =
        ends(&rate.iter().copied().filter(|r| r.abs() >= 0.5 * largest).collect::<Vec<_>>());
    if from <= to { vec![Place { domain: Domain::InputRate, from, to }] } else { vec![] }
}

/// True for a column that changes by more than the rounding of its numbers.
pub(in crate::effect) fn varies(column: Option<&[f64]>) -> bool {
    let Some(column) = column else { return false };
    column.len() >= 8 && column.iter().all(|x| x.is_finite()) && ends(column).is_wide()
}

/// The time before the first sample's own interval: where the record begins, whatever the samples average.
pub(in crate::effect) fn beginning_s(drivers: &Drivers) -> f64 {
    let m = drivers.averaged.max(1) as f64;
    drivers.start_s - 0.5 * (m - 1.0) / m * drivers.dt_s
}

/// The whole record in time.
pub(in crate::effect) fn record(drivers: &Drivers) -> Vec<Place> {
    let last = drivers.samples.saturating_sub(1);
    vec![Place { domain: Domain::Time, from: drivers.time_s(0), to: drivers.time_s(last) }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_column_says_nothing() {
        let constant = vec![20.0; 50];
        let rounded: Vec<f64> = (0..50).map(|i| 20.0 + 1e-12 * f64::from(i % 3)).collect();
        let levels: Vec<f64> = (0..50).map(|i| if i < 20 { 4.9 } else { 5.1 }).collect();
        assert!(!varies(None) && !varies(Some(&constant)) && !varies(Some(&rounded)));
        assert!(varies(Some(&levels)));
        assert!(!varies(Some(&[f64::NAN; 20])));
    }

    #[test]
    fn large_rates_are_those_from_half_of_the_largest() {
        let over = |rates: &[f64]| {
            let drivers = Drivers { table_rate: Some(rates.to_vec()), ..Drivers::default() };
            large_rates(&drivers).first().map(|p| (p.from, p.to))
        };
        assert_eq!(over(&[0.0, 4.0, 5.0, 10.0]), Some((5.0, 10.0)));
        assert_eq!(over(&[-10.0, 4.0, 6.0]), Some((-10.0, 6.0)));
        assert_eq!(over(&[]), None);
    }

    #[test]
    fn an_effect_lives_where_its_contribution_is_large() {
        let column: Vec<f64> = (0..=100).map(f64::from).collect();
        let contribution: Vec<f64> = column.iter().map(|x| if *x > 80.0 { 1.0 } else { 0.0 }).collect();
        let places = reach(Domain::Temperature, &column, &contribution);
        assert_eq!((places[0].from, places[0].to), (81.0, 100.0));
        assert!(reach(Domain::Temperature, &[], &[]).is_empty());
    }
}
