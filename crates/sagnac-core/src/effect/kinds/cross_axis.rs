//! Sensitivity to the rate about the other axis.

use super::reach::{reach, varies};
use crate::effect::{Both, Doc, Domain, Drivers, Param, Place};

pub struct CrossAxis;

static DOC: Doc = Doc {
    title: Both {
        en: "cross-axis sensitivity", ru: "перекрёстная чувствительность"
    },
    mechanism: Both {
        en: "The input axis is not square to the table's other axis.",
        ru: "Ось чувствительности не перпендикулярна второй оси стола.",
    },
    formula: Both { en: "10⁻³·δ·Ω_outer", ru: "10⁻³·δ·Ω_внеш" },
    signature: Both {
        en: "A straight line in residual against the rate of the other axis.",
        ru: "Прямая остатка по скорости второй оси.",
    },
    told_by: Both {
        en: "It vanishes while the other axis rests, whatever the input axis does.",
        ru: "Исчезает, когда вторая ось неподвижна, что бы ни делала входная.",
    },
    confirm: Both {
        en: "Turn the other axis alone, both ways, in two mountings a quarter turn apart.",
        ru: "Вращать только вторую ось в обе стороны в двух установках с поворотом на 90°.",
    },
    source: "IEEE Std 952, 12.12: input-axis misalignment",
};

static PARAMS: [Param; 1] = [Param::reported("misalignment_mrad", "mrad", -200.0, 200.0)];

describe! {
    CrossAxis, "cross_axis", Mean in OuterRate, needs [OuterRate],
    confusers ["sf_error", "earth_rate_projection"]
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    Some(drivers.outer_rate.as_ref()?.iter().map(|r| 3.6 * r).collect())
}

fn places(drivers: &Drivers) -> Vec<Place> {
    let outer = drivers.outer_rate.as_deref().unwrap_or(&[]);
    reach(Domain::OuterRate, outer, outer)
}

linear! { CrossAxis, replaces None, places places }

fn applies(drivers: &Drivers) -> bool {
    varies(drivers.outer_rate.as_deref())
}
