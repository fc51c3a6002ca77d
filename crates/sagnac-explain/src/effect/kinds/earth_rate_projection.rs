//! The Earth rate as a function of heading is wrong or missing.

use crate::effect::shared::sinusoid::{polar, wave};
use crate::effect::shared::table_angle::columns;
use crate::effect::sizing::numbers;
use crate::effect::{Drivers, MeanModel, Param, Regressors, Sizing, Values, number};

pub struct EarthRateProjection;

static PARAMS: [Param; 2] =
    [Param::reported("amplitude_deg_h", "deg/h", 0.0, 31.0), Param::inner("phase_deg", "deg", -360.0, 360.0)];

describe! {
    EarthRateProjection, "earth_rate_projection", Mean in Angle, needs [TableAngle],
    confusers [TableHarmonic, HeadingChange, Line]
}

impl EarthRateProjection {
    /// Values by which a claim states cos·cos(angle) + sin·sin(angle), deg/h.
    pub(super) fn claimed(cos: f64, sin: f64) -> Values {
        let (amplitude, phase) = polar(&[cos, sin]);
        numbers([(PARAMS[0].name, amplitude), (PARAMS[1].name, phase)])
    }
}

impl MeanModel for EarthRateProjection {
    fn regressors(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors::columns(columns(1.0, drivers))
    }

    fn parameters(
        &self,
        _nonlinear_parameters: &[f64],
        coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<f64> {
        let (amplitude, phase) = polar(coefficients);
        vec![amplitude, phase]
    }

    fn sizings(&self, _drivers: &Drivers) -> Vec<Sizing> {
        let places = [0.0, 45.0, 90.0, 135.0].map(|phase| numbers([(PARAMS[1].name, phase)]));
        vec![Sizing::searched(&PARAMS[0], places.into(), 2, 1.0)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        drivers.table_angle.as_ref()?;
        let phase = number(values, PARAMS[1].name).unwrap_or(0.0);
        Some(wave(number(values, PARAMS[0].name)?, phase, &columns(1.0, drivers)))
    }

    /// A table that turns is no heading: what repeats with its angle is more likely the table's own, or that of the gyro
    /// on it.
    fn odds(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> f64 {
        let turns = drivers.table_rate.as_ref().is_some_and(|r| r.iter().any(|r| r.abs() > 1e-6));
        if drivers.claim.earth.is_none() && turns { -2.0 } else { 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resting_table_shows_the_projection_at_its_angle() {
        let drivers =
            Drivers { dt_s: 1.0, samples: 3, table_angle: Some(vec![60.0; 3]), ..Drivers::default() };
        let stated = numbers([("amplitude_deg_h", 10.0), ("phase_deg", 30.0)]);
        let course = EarthRateProjection.course(&stated, &drivers).unwrap();
        assert!(course.iter().all(|x| x.abs() < 1e-12), "{course:?}");
        let course = EarthRateProjection.course(&numbers([("amplitude_deg_h", 10.0)]), &drivers).unwrap();
        assert!(course.iter().all(|x| (x - 5.0).abs() < 1e-12), "{course:?}");
    }
}
