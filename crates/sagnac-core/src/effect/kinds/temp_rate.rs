//! Bias proportional to the rate of change of temperature.

use super::reach::{reach, varies};
use super::thermal::rate;
use crate::effect::{
    Both, Doc, Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, number,
};

pub struct TempRate;

static DOC: Doc = Doc {
    title: Both {
        en: "temperature-rate sensitivity (Shupe effect)",
        ru: "чувствительность к скорости изменения температуры (эффект Шупе)",
    },
    mechanism: Both {
        en: "Both waves pass a warming stretch of the fibre at different times; what is not wound symmetrically remains as a rate.",
        ru: "Встречные волны проходят нагреваемый участок волокна в разное время; несимметричная часть намотки даёт ложную скорость.",
    },
    formula: Both::same("D·dT/dt"),
    signature: Both {
        en: "A pulse at each thermal ramp that changes its sign with the ramp; a straight line against dT/dt; a loop against temperature.",
        ru: "Импульс на каждом изменении температуры, меняющий знак вместе с ним; прямая по dT/dt; петля по температуре.",
    },
    told_by: Both {
        en: "A delay of the claimed dependence looks the same where that is a straight line and only one rate of heating occurs; hysteresis does not depend on the rate of heating.",
        ru: "Запаздывание заявленной зависимости выглядит так же, если она линейна и скорость нагрева одна; гистерезис от скорости нагрева не зависит.",
    },
    confirm: Both {
        en: "Two rates of heating and of cooling over the same temperatures.",
        ru: "Две скорости нагрева и охлаждения в одном диапазоне температур.",
    },
    source: "D. Shupe, Appl. Opt. 19(5) 654 (1980)",
};

static PARAMS: [Param; 1] =
    [Param::reported("coefficient_deg_h_per_degC_per_min", "deg/h/(°C/min)", -1e6, 1e6)];

describe! {
    TempRate, "temp_rate", Mean in TemperatureRate, needs [Temperature],
    confusers ["thermal_lag", "temp_hysteresis", "temp_linear"]
}

impl MeanModel for TempRate {
    fn applies(&self, drivers: &Drivers) -> bool {
        varies(drivers.temperature.as_deref()) && varies(rate(drivers).as_deref())
    }

    fn starts(&self, _drivers: &Drivers, _look: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<(f64, f64)> {
        vec![]
    }

    fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> Regressors {
        Regressors { columns: rate(drivers).into_iter().collect(), ..Regressors::default() }
    }

    fn parameters(&self, _shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        vec![coefficients.first().copied().unwrap_or(f64::NAN)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let coefficient = number(values, PARAMS[0].name)?;
        Some(rate(drivers)?.into_iter().map(|r| coefficient * r).collect())
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        rate(drivers).map_or_else(Vec::new, |r| reach(Domain::TemperatureRate, &r, &r))
    }
}
