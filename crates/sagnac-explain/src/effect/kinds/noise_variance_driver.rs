//! The level of the noise follows a recorded column.

use crate::effect::shared::chance::{is_chance, moved};
use crate::effect::shared::knots::{Knots, values_of_knots};
use crate::effect::shared::noise_level::scale;
use crate::effect::shared::variance::{
    GammaFit, Group, between, by_value, contrast, contrast_of_forms, fit, overdispersion, raised, thinned,
};
use crate::effect::{
    COLUMN_TEXT, Column, Detector, Drivers, FlatResidual, Knot, Law, Level, LevelDetector, LevelLaw, Param,
    Place, Samples, Value, Values, list, text,
};
use crate::numeric::range::{Bounds, ends};

pub struct NoiseVarianceDriver;

static PARAMS: [Param; 1] = [Param::reported("ratio", "", 1.0, 1e3)];

/// Names of the lists of values of the column and of the ratios to the claimed level there.
const KNOT_VALUES: &str = "knots_value";
const KNOT_RATIOS: &str = "knots_ratio";

describe! {
    NoiseVarianceDriver, "noise_variance_driver", Samples in Driver, needs [],
    confusers [NoiseVarianceTime, OutlierBursts, ColumnDriver],
    lists [
        Param::inner(KNOT_VALUES, "", f64::MIN, f64::MAX),
        Param::inner(KNOT_RATIOS, "", 0.0, 1e3)
    ],
    texts [COLUMN_TEXT],
    properties [carried_over]
}

impl Samples for NoiseVarianceDriver {
    fn apply(&self, values: &Values, drivers: &Drivers, _seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        let Some(column) = text(values, COLUMN_TEXT).and_then(|name| drivers.column(Column::of_name(name)))
        else {
            return;
        };
        if let Some(knots) = Knots::new(list(values, KNOT_VALUES), list(values, KNOT_RATIOS)) {
            let at = |i: usize| column.get(i).map_or(1.0, |v| knots.at(*v).max(0.0));
            scale(drivers, rate, at);
        }
    }

    fn detector(&self) -> Detector {
        Detector::Level(&NoiseVarianceDriver)
    }
}

impl LevelDetector for NoiseVarianceDriver {
    /// One law over each column.
    fn laws(&self, residual: &FlatResidual<'_>, samples: &[usize]) -> Vec<LevelLaw> {
        let one = |column: Column| {
            let values = residual.drivers.column(column).filter(|v| ends(v).is_wide())?;
            over_column(column, values, residual, samples)
        };
        let mut out: Vec<LevelLaw> = residual.drivers.columns().filter_map(one).collect();
        let columns = out.len() as f64;
        out.iter_mut().for_each(|law| law.trials *= columns);
        out
    }

    fn stated(&self, level: &Level, _drivers: &Drivers) -> Values {
        let Law::Column(column, knots) = &level.law else { return Values::new() };
        let named = (COLUMN_TEXT.to_owned(), Value::Text(column.name().to_owned()));
        values_of_knots(knots, KNOT_VALUES, KNOT_RATIOS).into_iter().chain([named]).collect()
    }
}

/// Gain of a shifted column, nats, over the dispersion of the groups, up to which it is that of an even level.
const MAX_EVEN_GAIN: f64 = 8.0;

/// A level fitted over the values of a column.
struct LevelFit {
    groups: Vec<Group>,
    /// Mean value of each group.
    means: Vec<f64>,
    /// Columns in which the logarithm of the level is linear.
    columns: Vec<Vec<f64>>,
    best: GammaFit,
    /// Largest deviation over the smallest, with its interval over both forms.
    ratio: f64,
    ci95: [f64; 2],
}

/// The level of `flat` over the values of a column: a line or a parabola in its logarithm.
fn over(values: &[f64], flat: &[f64], samples: &[usize]) -> Option<LevelFit> {
    let (groups, means) = by_value(|i| values[i], flat, samples);
    let Bounds { low, high } = ends(&means);
    if !ends(&means).is_wide() {
        return None;
    }
    let centred = |v: f64| (2.0 * v - low - high) / (high - low);
    let x: Vec<f64> = means.iter().map(|v| centred(*v)).collect();
    let square = |v: &f64| 1.5 * v * v - 0.5;
    let orders = [vec![x.clone()], vec![x.clone(), x.iter().map(square).collect()]];
    let rows = (samples.len() as f64).ln();
    let fits: Vec<(GammaFit, Vec<Vec<f64>>)> =
        orders.into_iter().filter_map(|columns| Some((fit(&groups, &columns)?, columns))).collect();
    let score = |(f, columns): &(GammaFit, Vec<Vec<f64>>)| 2.0 * f.gain - columns.len() as f64 * rows;
    let contrast =
        |(f, columns): &(GammaFit, Vec<Vec<f64>>)| contrast(&f.log_squares, &f.covariance, columns);
    let of_forms: Vec<(f64, [f64; 2])> = fits.iter().map(|f| (score(f), contrast(f).1)).collect();
    let fitted = fits.into_iter().max_by(|a, b| score(a).total_cmp(&score(b)))?;
    let (ratio, of_best) = contrast(&fitted);
    let ci95 = contrast_of_forms(&of_forms).unwrap_or(of_best);
    let (best, columns) = fitted;
    Some(LevelFit { groups, means, columns, best, ratio, ci95 })
}

/// The law over the values of a column that the level follows; `None` where the level that it leaves follows the same column shifted
/// in time about as well.
fn over_column(
    column: Column,
    values: &[f64],
    residual: &FlatResidual<'_>,
    samples: &[usize],
) -> Option<LevelLaw> {
    // The input rate is an effect of its own, and averages hold no angles.
    if matches!(column, Column::TableRate | Column::TableAngle) {
        return None;
    }
    let own = over(values, &residual.flat, samples)?;
    let knots: Vec<Knot> = own
        .means
        .iter()
        .zip(&own.best.log_squares)
        .map(|(v, l)| Knot { at: *v, value: (0.5 * l).exp() })
        .collect();
    let Bounds { low: from, high: to } = raised(&own.means, &own.best.log_squares);
    let free = own.columns.len();
    let profile: Vec<f64> = values.iter().map(|v| between(&knots, *v)).collect();
    let left: Vec<f64> = residual.flat.iter().zip(&profile).map(|(e, g)| e / g).collect();
    let score =
        |o: &LevelFit| o.best.gain / overdispersion(&o.groups, &o.best.log_squares, o.columns.len() + 1);
    let of_slide = |slide: usize| over(&moved(values, slide), &left, samples).as_ref().map_or(0.0, score);
    if is_chance(score(&own), MAX_EVEN_GAIN, of_slide) {
        return None;
    }
    let LevelFit { groups, best, ratio, ci95, .. } = own;
    Some(LevelLaw {
        profile,
        law: Law::Column(column, thinned(&knots)),
        gain: best.gain,
        trials: 2.0,
        free,
        parameters: free,
        dispersion: overdispersion(&groups, &best.log_squares, free + 1),
        ratio,
        ci95,
        place: Place { domain: column.domain(), from, to },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::OtherDriver;

    #[test]
    fn deviations_are_scaled_by_the_value_of_the_column() {
        let values = vec![0.0, 5.0, 10.0];
        let other = OtherDriver { column: Column::of_name("humidity_pct"), smooth: values.clone(), values };
        let drivers = Drivers { dt_s: 1.0, samples: 3, others: vec![other], ..Drivers::default() };
        let stated = |column: &str| {
            Values::from([
                (COLUMN_TEXT.to_owned(), Value::Text(column.to_owned())),
                (KNOT_VALUES.to_owned(), Value::List(vec![0.0, 10.0])),
                (KNOT_RATIOS.to_owned(), Value::List(vec![1.0, 3.0])),
            ])
        };
        let mut rate = vec![1.0; 3];
        NoiseVarianceDriver.apply(&stated("humidity_pct"), &drivers, 1, &mut rate, &mut [true; 3]);
        assert_eq!(rate, [1.0, 2.0, 3.0]);
        NoiseVarianceDriver.apply(&stated("field_uT"), &drivers, 1, &mut rate, &mut [true; 3]);
        assert_eq!(rate, [1.0, 2.0, 3.0], "a column that is not there changes nothing");
    }

    #[test]
    fn a_level_that_follows_something_else_follows_no_column() {
        let n = 20_000;
        let mut state = 7u64;
        let mut normal = || {
            let mut uniform = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            };
            (0..12).map(|_| uniform()).sum::<f64>()
        };
        let at = |i: usize, periods: f64| (std::f64::consts::TAU * periods * i as f64 / n as f64).sin();
        let column: Vec<f64> = (0..n).map(|i| at(i, 3.0)).collect();
        let drivers =
            Drivers { dt_s: 1.0, samples: n, temperature: Some(column.clone()), ..Drivers::default() };
        let usable = vec![true; n];
        let mut law = |level: &dyn Fn(usize) -> f64| {
            let flat = (0..n).map(|i| level(i) * normal()).collect();
            let residual = FlatResidual {
                white: vec![],
                flat,
                per_deg_h: 1.0,
                ends: 0,
                usable: &usable,
                drivers: &drivers,
                rounding_step: 0.0,
            };
            let samples: Vec<usize> = (0..n).collect();
            over_column(Column::Temperature, &column, &residual, &samples)
        };
        // By the column itself: a ratio of e^0.6.
        let follows = law(&|i| (0.3 * column[i]).exp()).unwrap();
        assert!((follows.ratio.ln() - 0.6).abs() < 0.1 && follows.gain > 100.0, "{}", follows.ratio);
        // By something at a pace of its own that goes partly with it.
        assert!(law(&|i| (0.3 * at(i, 3.3)).exp()).is_none());
    }
}
