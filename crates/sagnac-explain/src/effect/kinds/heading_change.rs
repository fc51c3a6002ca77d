//! The gyro moved: another projection of the Earth rate from some time on.

use super::bias_step::BiasStep;
use super::earth_rate_projection::EarthRateProjection;
use crate::effect::shared::heading::{odds_of_same_step, table_turned, turning};
use crate::effect::shared::search::gain_of;
use crate::effect::shared::step::{around, instant_bounds, instants, sizing, step};
use crate::effect::{
    ClaimedMean, Drivers, Earth, Effect, Later, MeanModel, Param, Place, Regressors, SearchContext, Sizing,
    Starts, Values, number,
};
use crate::numeric::order::SortByNumber;
use crate::numeric::range::Bounds;
use crate::units::EARTH_RATE_DEG_H;
use std::f64::consts::PI;

pub struct HeadingChange;

static PARAMS: [Param; 4] = [
    Param::reported("step_deg_h", "deg/h", -1e3, 1e3).signed(),
    Param::reported("time_s", "s", f64::MIN, f64::MAX).instant(),
    Param::inner("cosine_deg_h", "deg/h", -1e3, 1e3),
    Param::inner("sine_deg_h", "deg/h", -1e3, 1e3),
];

describe! {
    HeadingChange, "heading_change", Mean in Time, needs [],
    confusers [BiasStep, EarthRateProjection, RandomTelegraph],
    properties [family Jump],
    with {
        fn later(&self, values: &Values, claim: &ClaimedMean) -> Later {
            let number = |i: usize| number(values, PARAMS[i].name);
            let (cos, sin) = match (number(2), number(3), number(0)) {
                (Some(cos), Some(sin), _) => (cos, sin),
                (_, _, Some(step)) => projection_of(step, claim.earth),
                _ => return Later::Same,
            };
            Later::As(&EarthRateProjection, EarthRateProjection::claimed(cos, sin))
        }
    }
}

/// The change of the projection, as cosine and sine of the table's angle, by the smallest turn of the gyro that changes
/// the rate at angle 0 by `step` deg/h. Where no latitude is stated, the change at angle 0 is all that is known of it.
fn projection_of(step: f64, earth: Option<Earth>) -> (f64, f64) {
    let Some(earth) = earth else { return (step, 0.0) };
    let horizontal = EARTH_RATE_DEG_H * earth.latitude_deg.to_radians().cos();
    let before = earth.azimuth_deg.to_radians();
    let heading = (before.cos() + step / horizontal).clamp(-1.0, 1.0).acos();
    let apart = |h: f64| (h - before + PI).rem_euclid(2.0 * PI) - PI;
    let turn = [heading, -heading].map(apart).into_iter().min_by(|a, b| a.abs().total_cmp(&b.abs()));
    let after = before + turn.unwrap_or(0.0);
    (horizontal * (after.cos() - before.cos()), -horizontal * (after.sin() - before.sin()))
}

/// Number of instants at which the search looks for a change of heading.
const HEADING_INSTANTS: usize = 128;

/// Instants from which on another projection gains most, s after the first sample; the best first. Looked at on a grid:
/// the gain falls off slowly from the right one, and the fit of the shape goes on from there.
fn turned_instants(drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
    let n = drivers.samples;
    let points = HEADING_INSTANTS.min(n / 4);
    let mut rated: Vec<(f64, Vec<f64>)> = (1..points)
        .map(|p| {
            let nonlinear_parameters = vec![((n * p / points) as f64 - 0.5) * drivers.dt_s];
            (gain_of(HeadingChange.regressors(&nonlinear_parameters, drivers), context), nonlinear_parameters)
        })
        .collect();
    rated.sort_descending_by(|a| a.0);
    Starts { points: rated.into_iter().take(3).map(|r| r.1).collect(), trials: (n as f64).powf(0.75) }
}

impl MeanModel for HeadingChange {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= 8
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        match turning(drivers) {
            Some(_) => turned_instants(drivers, context),
            None => instants(drivers, context),
        }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        vec![instant_bounds(drivers)]
    }

    /// A step; with a table that turns, the projection as a function of its angle from then on.
    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let Some(at) = nonlinear_parameters.first() else { return Regressors::default() };
        let step = step(drivers, *at);
        let Some(angle) = turning(drivers) else { return Regressors::columns([step]) };
        let projected =
            |part: fn(f64) -> f64| step.iter().zip(angle).map(|(s, a)| s * part(a.to_radians())).collect();
        Regressors::columns([f64::cos, f64::sin].map(projected))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        match (nonlinear_parameters, coefficients) {
            ([at], [size]) => vec![*size, drivers.start_s + at, f64::NAN, f64::NAN],
            ([at], [cos, sin]) => vec![f64::NAN, drivers.start_s + at, *cos, *sin],
            _ => vec![f64::NAN; 4],
        }
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        if turning(drivers).is_some() {
            return vec![];
        }
        vec![sizing(&PARAMS[0], &PARAMS[1], drivers)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let at = number(values, PARAMS[1].name)? - drivers.start_s;
        let step = step(drivers, at);
        let of = |i: usize| number(values, PARAMS[i].name);
        if let (Some(cos), Some(sin), Some(angle)) = (of(2), of(3), &drivers.table_angle) {
            let turned = |a: f64| cos * a.to_radians().cos() + sin * a.to_radians().sin();
            return Some(step.iter().zip(angle).map(|(s, a)| s * turned(*a)).collect());
        }
        let size = of(0)?;
        Some(step.into_iter().map(|s| size * s).collect())
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        nonlinear_parameters.first().map(|at| around(*at, drivers)).into_iter().collect()
    }

    /// For it where the table's angle changes then and seldom else. Of a gyro at rest nothing tells it from a step of the output,
    /// which is the plainer name: it is nearly as probable where the claim states the Earth rate, and less so where it does not.
    /// Of a table that turns, the claim decides.
    fn odds(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> f64 {
        let Some(at) = nonlinear_parameters.first() else { return 0.0 };
        let of_claim = if drivers.claim.earth.is_some() { 1.0 } else { -3.0 };
        if table_turned(*at, drivers) { 6.0 } else { odds_of_same_step(*at, drivers).unwrap_or(of_claim) }
    }

    fn plainer_name(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<&'static str> {
        odds_of_same_step(*nonlinear_parameters.first()?, drivers).map(|_| BiasStep.kind())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_of_the_table_at_that_instant_speaks_for_it() {
        let angle = |at: usize| (0..1000).map(|i| if i < at { 10.0 } else { 25.0 }).collect::<Vec<f64>>();
        let mut drivers = Drivers { dt_s: 1.0, samples: 1000, ..Drivers::default() };
        assert!(HeadingChange.odds(&[500.0], &drivers) < 0.0);
        drivers.table_angle = Some(angle(500));
        assert!(HeadingChange.odds(&[500.0], &drivers) > 0.0);
        assert!(HeadingChange.odds(&[200.0], &drivers) < 0.0);
        // At rest a step is the plainer name, whatever the claim states.
        let mut at_rest = Drivers { dt_s: 1.0, samples: 1000, ..Drivers::default() };
        at_rest.claim.earth = Some(Earth { latitude_deg: 60.0, azimuth_deg: 40.0 });
        let odds = HeadingChange.odds(&[500.0], &at_rest);
        assert!(odds < 0.0 && odds > -0.5, "{odds}");
        assert_eq!(HeadingChange.plainer_name(&[500.0], &at_rest), Some(BiasStep.kind()));
        assert_eq!(HeadingChange.plainer_name(&[500.0], &drivers), None);
    }

    #[test]
    fn a_gyro_that_turned_sees_another_projection_at_every_angle_of_the_table() {
        let earth = Earth { latitude_deg: 60.0, azimuth_deg: 40.0 };
        let horizontal = 0.5 * EARTH_RATE_DEG_H;
        let at = |heading: f64| horizontal * heading.to_radians().cos();
        // Turned by 3°, from 40° to 43°.
        let (cos, sin) = projection_of(at(43.0) - at(40.0), Some(earth));
        for angle in [0.0f64, 50.0, 200.0] {
            let seen = cos * angle.to_radians().cos() + sin * angle.to_radians().sin();
            assert!((seen - (at(43.0 + angle) - at(40.0 + angle))).abs() < 1e-9, "{angle}: {seen}");
        }
        assert_eq!(projection_of(0.3, None), (0.3, 0.0));
    }
}
