//! A contribution that is periodic in the table angle.

use crate::effect::mean::first;
use crate::effect::shared::search::best_of;
use crate::effect::shared::sinusoid::{polar, wave};
use crate::effect::shared::table_angle::columns;
use crate::effect::sizing::numbers;
use crate::effect::{Drivers, MeanModel, Param, Regressors, SearchContext, Sizing, Starts, Values, number};
use crate::numeric::range::Bounds;

pub struct TableHarmonic;

static PARAMS: [Param; 3] = [
    Param::reported("order", "", 1.0, 8.0).whole(),
    Param::reported("amplitude_deg_h", "deg/h", 0.0, 1e5),
    Param::inner("phase_deg", "deg", -360.0, 360.0),
];

describe! {
    TableHarmonic, "table_harmonic", Mean in Angle, needs [TableAngle],
    confusers [EarthRateProjection, Line, ResetRipple]
}

impl MeanModel for TableHarmonic {
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let orders = (1..=8).map(|k| vec![f64::from(k)]);
        Starts { points: best_of(self, orders, 3, drivers, context), trials: 8.0 }
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(1.0, 8.0)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors::columns(nonlinear_parameters.iter().flat_map(|order| columns(order.round(), drivers)))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        let (amplitude, phase) = polar(coefficients);
        vec![first(nonlinear_parameters).round(), amplitude, phase]
    }

    fn sizings(&self, _drivers: &Drivers) -> Vec<Sizing> {
        let of = |order: u8| {
            [0.0, 90.0].map(|phase| numbers([(PARAMS[0].name, f64::from(order)), (PARAMS[2].name, phase)]))
        };
        vec![Sizing::searched(&PARAMS[1], (1..=8).flat_map(of).collect(), 2, 8.0)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        drivers.table_angle.as_ref()?;
        let (order, amplitude) = (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)?);
        let phase = number(values, PARAMS[2].name).unwrap_or(0.0);
        Some(wave(amplitude, phase, &columns(order, drivers)))
    }

    fn whole(&self) -> &'static [usize] {
        &[0]
    }
}
