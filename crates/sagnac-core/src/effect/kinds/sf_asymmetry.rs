//! Different scale factors for positive and negative rate.

use super::sf_error::large_rates;
use crate::effect::{Both, Doc, Drivers, Param};
use crate::numeric::range::ends;

pub struct SfAsymmetry;

static DOC: Doc = Doc {
    title: Both {
        en: "scale-factor asymmetry", ru: "асимметрия масштабного коэффициента"
    },
    mechanism: Both {
        en: "Modulator and loop treat the two senses of rotation differently.",
        ru: "Модулятор и контур обратной связи по-разному отрабатывают два направления вращения.",
    },
    formula: Both::same("10⁻⁶·(ε_a/2)·|Ω|"),
    signature: Both {
        en: "A V in residual against input rate.",
        ru: "Галочка в зависимости остатка от входной скорости.",
    },
    told_by: Both {
        en: "An error of the scale factor is odd in the rate; a quadratic term is round at small rates; heating by the rotation depends on the order of the rates.",
        ru: "Ошибка масштабного коэффициента нечётна по скорости; квадратичный член скруглён у нуля; нагрев от вращения зависит от порядка скоростей.",
    },
    confirm: Both {
        en: "Remount the gyro turned over and repeat.",
        ru: "Перевернуть гироскоп на столе и повторить.",
    },
    source: "IEEE Std 952, 12.9; IEEE Std 528: asymmetry error",
};

static PARAMS: [Param; 1] = [Param::reported("asymmetry_ppm", "ppm", -1e5, 1e5)];

describe! {
    SfAsymmetry, "sf_asymmetry", Mean in InputRate, needs [TableRate],
    confusers ["sf_error", "sf_nonlinearity", "temp_linear"]
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    Some(drivers.table_rate.as_ref()?.iter().map(|r| 1800e-6 * r.abs()).collect())
}

linear! { SfAsymmetry, replaces None, places large_rates }

/// Rates of one sign alone cannot show it.
fn applies(drivers: &Drivers) -> bool {
    let Some(rate) = &drivers.table_rate else { return false };
    let (low, high) = ends(rate);
    low.is_finite() && high.is_finite() && low < -0.01 * high.abs() && high > 0.01 * low.abs()
}
