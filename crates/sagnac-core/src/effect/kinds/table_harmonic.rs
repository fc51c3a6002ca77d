//! A contribution that is periodic in the table angle.

use super::reach::varies;
use super::search::best_of;
use super::sinusoid::{averaged, pair, polar, wave};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, Resolution, SearchContext, Starts, Values, number,
};
use crate::numeric::range::{Bounds, ends};

pub struct TableHarmonic;

static PARAMS: [Param; 3] = [
    Param::reported("order", "", 1.0, 8.0).whole(),
    Param::reported("amplitude_deg_h", "deg/h", 0.0, 1e5),
    Param::inner("phase_deg", "deg", -360.0, 360.0),
];

describe! {
    TableHarmonic, "table_harmonic", Mean in Angle, needs [TableAngle],
    confusers ["earth_rate_projection", "line", "reset_ripple"]
}

/// Turn of the table within a sample, in turns: from the rate where it is there, else from the neighbouring angles.
fn turn(i: usize, angle: &[f64], drivers: &Drivers) -> f64 {
    if let Some(rate) = drivers.table_rate.as_ref().and_then(|r| r.get(i)) {
        return rate * drivers.dt_s / 360.0;
    }
    let (a, b) = (i.saturating_sub(1), (i + 1).min(angle.len() - 1));
    let apart = (angle[b] - angle[a] + 180.0).rem_euclid(360.0) - 180.0;
    if b > a { apart / (b - a) as f64 / 360.0 } else { 0.0 }
}

/// Cosine and sine of an order of the table angle, averaged over each sample.
pub(super) fn columns(order: f64, drivers: &Drivers) -> Vec<Vec<f64>> {
    let Some(angle) = &drivers.table_angle else { return vec![] };
    pair(angle.len(), |i| (order * angle[i] / 360.0, averaged(order * turn(i, angle, drivers))))
}

/// The angles that the table went through.
pub(super) fn visited(drivers: &Drivers) -> Vec<Place> {
    let Some(angle) = &drivers.table_angle else { return vec![] };
    let Bounds { low, high } = ends(angle);
    if low > high {
        return vec![];
    }
    let whole = high - low > 300.0;
    let (from, to) = if whole { (0.0, 360.0) } else { (low, high) };
    vec![Place { domain: Domain::Angle, from, to }]
}

impl MeanModel for TableHarmonic {
    fn resolution(&self) -> Resolution {
        Resolution::FullRate
    }

    fn applies(&self, drivers: &Drivers) -> bool {
        varies(drivers.table_angle.as_deref())
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let orders = (1..=8).map(|k| vec![f64::from(k)]);
        Starts { points: best_of(self, orders, 3, drivers, context), trials: 8.0 }
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(1.0, 8.0)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let free = nonlinear_parameters.first().map_or_else(Vec::new, |k| columns(k.round(), drivers));
        Regressors { columns: free, ..Regressors::default() }
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        let (amplitude, phase) = polar(coefficients);
        vec![nonlinear_parameters.first().map_or(f64::NAN, |k| k.round()), amplitude, phase]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        drivers.table_angle.as_ref()?;
        let (order, amplitude) = (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)?);
        let phase = number(values, PARAMS[2].name).unwrap_or(0.0);
        Some(wave(amplitude, phase, &columns(order, drivers)))
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        visited(drivers)
    }

    fn whole(&self) -> &'static [usize] {
        &[0]
    }
}
