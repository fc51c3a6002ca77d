//! A scale factor that differs from the claimed one.

use super::reach::varies;
use crate::effect::{Both, Doc, Domain, Drivers, Param, Place};
use crate::numeric::range::ends;

pub struct SfError;

static DOC: Doc = Doc {
    title: Both {
        en: "scale-factor error", ru: "ошибка масштабного коэффициента"
    },
    mechanism: Both {
        en: "Wavelength of the source, size of the coil or a constant in the firmware differ from what the simulation has.",
        ru: "Длина волны источника, размер контура или константа в прошивке отличаются от принятых в модели.",
    },
    formula: Both::same("10⁻⁶·ε·Ω"),
    signature: Both {
        en: "A straight line through zero in residual against input rate.",
        ru: "Прямая через ноль в зависимости остатка от входной скорости.",
    },
    told_by: Both {
        en: "Asymmetry makes a V of it, nonlinearity bends it, a time offset acts only while the rate changes.",
        ru: "Асимметрия превращает её в галочку, нелинейность изгибает, сдвиг времени действует лишь при изменении скорости.",
    },
    confirm: Both {
        en: "Whole turns at two rates against the table's own angle.",
        ru: "Целое число оборотов на двух скоростях по углу самого стола.",
    },
    source: "IEEE Std 952, 12.9: scale factor",
};

static PARAMS: [Param; 1] = [Param::reported("error_ppm", "ppm", -1e5, 1e5)];

describe! {
    SfError, "sf_error", Mean in InputRate, needs [TableRate],
    confusers ["sf_asymmetry", "sf_nonlinearity", "sf_temperature", "time_offset"]
}

/// Rates at which an effect that grows with the rate is at least half of its largest.
pub(super) fn large_rates(drivers: &Drivers) -> Vec<Place> {
    let Some(rate) = &drivers.table_rate else { return vec![] };
    let (from, to) = ends(rate);
    let largest = from.abs().max(to.abs());
    let (from, to) = ends(&rate.iter().copied().filter(|r| r.abs() >= 0.5 * largest).collect::<Vec<_>>());
    if from <= to { vec![Place { domain: Domain::InputRate, from, to }] } else { vec![] }
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    Some(drivers.table_rate.as_ref()?.iter().map(|r| 3600e-6 * r).collect())
}

linear! { SfError, replaces Some(crate::effect::Nuisance::ScaleFactor), places large_rates }

fn applies(drivers: &Drivers) -> bool {
    varies(drivers.table_rate.as_deref())
}
