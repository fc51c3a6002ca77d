//! A scale factor that depends on temperature.

use super::reach::{reach, varies};
use crate::effect::{Both, Doc, Domain, Drivers, Param, Place};

pub struct SfTemperature;

static DOC: Doc = Doc {
    title: Both {
        en: "temperature-dependent scale factor",
        ru: "зависимость масштабного коэффициента от температуры",
    },
    mechanism: Both {
        en: "The wavelength of the source and the size of the coil change with temperature.",
        ru: "Длина волны источника и размер контура меняются с температурой.",
    },
    formula: Both::same("10⁻⁶·ε_T·(T − T_ref)·Ω"),
    signature: Both {
        en: "The slope of residual against rate changes with temperature.",
        ru: "Наклон остатка по скорости меняется с температурой.",
    },
    told_by: Both {
        en: "A bias that follows the temperature keeps its sign when the rate changes its own; an error of the scale factor does not care for the temperature.",
        ru: "Зависимость смещения нуля от температуры не меняет знака вместе со скоростью; постоянная ошибка масштабного коэффициента не зависит от температуры.",
    },
    confirm: Both {
        en: "The same rates at two temperatures, soaked.",
        ru: "Те же скорости при двух установившихся температурах.",
    },
    source: "IEEE Std 952, 12.9: scale-factor temperature sensitivity",
};

static PARAMS: [Param; 1] = [Param::reported("coefficient_ppm_per_degC", "ppm/°C", -1e4, 1e4)];

describe! {
    SfTemperature, "sf_temperature", Mean in Temperature, needs [TableRate, Temperature],
    confusers ["sf_error", "temp_linear", "sf_nonlinearity"]
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    let from = drivers.claim.temperature.map_or(20.0, |t| t.reference_degc);
    let (rate, t) = (drivers.table_rate.as_ref()?, drivers.temperature.as_ref()?);
    Some(rate.iter().zip(t).map(|(r, t)| 3600e-6 * r * (t - from)).collect())
}

fn places(drivers: &Drivers) -> Vec<Place> {
    let course = column(drivers).unwrap_or_default();
    let mut out = reach(Domain::Temperature, drivers.temperature.as_deref().unwrap_or(&[]), &course);
    out.extend(super::sf_error::large_rates(drivers));
    out
}

linear! { SfTemperature, replaces None, places places }

fn applies(drivers: &Drivers) -> bool {
    let moving = drivers.table_rate.as_ref().is_some_and(|r| r.iter().any(|r| *r != 0.0));
    moving && varies(drivers.temperature.as_deref())
}
