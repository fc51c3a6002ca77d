//! The bias follows the supply voltage.

use super::reach::{reach, varies};
use crate::effect::{
    Both, Doc, Domain, Drivers, MeanModel, Param, Place, Regressors, Resolution, SearchContext, Starts,
    Values, number,
};

pub struct SupplySensitivity;

static DOC: Doc = Doc {
    title: Both {
        en: "supply sensitivity", ru: "чувствительность к напряжению питания"
    },
    mechanism: Both {
        en: "References, drivers and amplifiers let part of the supply through to the output.",
        ru: "Опорные источники, драйверы и усилители пропускают часть изменений питания на выход.",
    },
    formula: Both::same("k (U − U₀)"),
    signature: Both {
        en: "A straight line in residual against voltage; in time a copy of the supply, ripple and switching included.",
        ru: "Прямая остатка по напряжению; во времени — копия питания вместе с пульсациями и переключениями.",
    },
    told_by: Both {
        en: "A temperature that follows the load lags behind the voltage; a step without a step of the supply is none of it.",
        ru: "Температура, зависящая от нагрузки, отстаёт от напряжения; скачок без скачка питания сюда не относится.",
    },
    confirm: Both {
        en: "Step the supply by ±5 %.", ru: "Изменить питание на ±5 % скачком."
    },
    source: "IEEE Std 952, 12.11: supply sensitivity",
};

static PARAMS: [Param; 1] = [Param::reported("coefficient_deg_h_per_V", "deg/h/V", -1e5, 1e5)];

describe! {
    SupplySensitivity, "supply_sensitivity", Mean in Supply, needs [Supply],
    confusers ["temp_linear", "bias_step", "unobserved_driver"]
}

/// Voltage about its mean.
fn voltage(drivers: &Drivers) -> Option<Vec<f64>> {
    let supply = drivers.supply.as_ref()?;
    let mean = supply.iter().sum::<f64>() / supply.len().max(1) as f64;
    Some(supply.iter().map(|u| u - mean).collect())
}

impl MeanModel for SupplySensitivity {
    fn resolution(&self) -> Resolution {
        Resolution::FullRate
    }

    fn applies(&self, drivers: &Drivers) -> bool {
        varies(drivers.supply.as_deref())
    }

    fn starts(&self, _drivers: &Drivers, _look: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<(f64, f64)> {
        vec![]
    }

    fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> Regressors {
        Regressors { columns: voltage(drivers).into_iter().collect(), ..Regressors::default() }
    }

    fn parameters(&self, _shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        vec![coefficients.first().copied().unwrap_or(f64::NAN)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let coefficient = number(values, PARAMS[0].name)?;
        Some(voltage(drivers)?.into_iter().map(|u| coefficient * u).collect())
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let supply = drivers.supply.as_deref().unwrap_or(&[]);
        reach(Domain::Supply, supply, supply)
    }
}
