//! No or reduced response around zero input rate.

use super::search::{best_of, log_grid};
use crate::effect::{
    Both, Course, Doc, Domain, Drivers, Look, Pace, Param, Parts, Place, Starts, Values, number,
};

pub struct DeadZone;

static DOC: Doc = Doc {
    title: Both { en: "dead zone", ru: "зона нечувствительности" },
    mechanism: Both {
        en: "Cross-talk of the modulator's drive into the detector pulls the closed loop to a point where it cancels a small input.",
        ru: "Наводка сигнала модулятора на приёмник удерживает замкнутый контур в точке, где он гасит малую входную скорость.",
    },
    formula: "−c·Ω for |Ω| < w",
    signature: Both {
        en: "Within ±w the residual is the input with its sign changed; outside there is nothing.",
        ru: "В пределах ±w остаток равен входной скорости с обратным знаком; снаружи его нет.",
    },
    told_by: Both {
        en: "Quantisation leaves a lattice at every rate; an error of the scale factor goes on outside.",
        ru: "Квантование оставляет решётку на любой скорости; ошибка масштабного коэффициента продолжается и снаружи.",
    },
    confirm: Both {
        en: "Sweep slowly through zero; switch phase jumps or dither of the loop on.",
        ru: "Медленно пройти через ноль; включить скачки фазы или вибрационную подставку контура.",
    },
    source: "US patent 6,744,519; IEEE Std 952, 12.10: dead band",
};

static PARAMS: [Param; 2] =
    [Param::reported("half_width_deg_h", "deg/h", 0.0, 1e6), Param::inner("lost_share", "", 0.0, 1.2)];

describe! {
    DeadZone, "dead_zone", Course in InputRate, needs [TableRate],
    confusers ["sf_nonlinearity", "sf_error", "quantization"]
}

fn column(half_width: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let rate = drivers.table_rate.as_ref()?;
    let inside = |r: &f64| if (3600.0 * r).abs() < half_width { -3600.0 * r } else { 0.0 };
    Some(rate.iter().map(inside).collect())
}

/// Distinct sizes of the rate in order, deg/h, at most 64 of them.
fn sizes(drivers: &Drivers) -> Vec<f64> {
    let rates = drivers.table_rate.iter().flatten();
    let mut sizes: Vec<f64> =
        rates.map(|r| (3600.0 * r).abs()).filter(|r| r.is_finite() && *r > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup_by(|a, b| *a - *b < 1e-6 * *b);
    let step = sizes.len().div_ceil(64).max(1);
    sizes.into_iter().step_by(step).collect()
}

impl Course for DeadZone {
    fn pace(&self) -> Pace {
        Pace::Fast
    }

    fn applies(&self, drivers: &Drivers) -> bool {
        sizes(drivers).len() >= 3
    }

    /// Between neighbouring sizes of the rate every width is the same: their middles are looked at.
    fn starts(&self, drivers: &Drivers, look: &Look<'_>) -> Starts {
        let sizes = sizes(drivers);
        let mut widths: Vec<f64> = sizes.windows(2).map(|w| (w[0] * w[1]).sqrt()).collect();
        // Rates that pass through zero have few samples close to it.
        if let (Some(low), Some(high), true) = (sizes.first(), sizes.last(), sizes.len() > 32) {
            widths.extend(log_grid(*low, *high, 32));
        }
        let shapes = best_of(self, widths.into_iter().map(|w| vec![w]), 3, drivers, look);
        Starts { shapes, looked: sizes.len().max(1) as f64 }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<(f64, f64)> {
        let sizes = sizes(drivers);
        match (sizes.first(), sizes.last()) {
            (Some(low), Some(high)) => vec![(*low, high.max(*low))],
            _ => vec![(1e-9, 1e-9)],
        }
    }

    fn parts(&self, shape: &[f64], drivers: &Drivers) -> Parts {
        let free = shape.first().and_then(|w| column(*w, drivers)).into_iter().collect();
        Parts { free, ..Parts::default() }
    }

    fn parameters(&self, shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        match (shape, coefficients) {
            ([width], [share]) => vec![*width, *share],
            _ => vec![f64::NAN; 2],
        }
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let share = number(values, PARAMS[1].name).unwrap_or(1.0);
        let column = column(number(values, PARAMS[0].name)?, drivers)?;
        Some(column.into_iter().map(|x| share * x).collect())
    }

    fn places(&self, shape: &[f64], _coefficients: &[f64], _drivers: &Drivers) -> Vec<Place> {
        let at = |w: &f64| Place { domain: Domain::InputRate, from: -w / 3600.0, to: w / 3600.0 };
        shape.first().map(at).into_iter().collect()
    }
}
