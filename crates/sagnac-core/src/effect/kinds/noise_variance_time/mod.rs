//! The level of the noise changes during the record.

mod forms;

use crate::effect::shared::knots::Knots;
use crate::effect::shared::variance::{between, by_value, contrast, fit, overdispersion, raised, thinned};
use crate::effect::{
    Column, Detector, Domain, Drivers, FlatResidual, Knot, Law, Level, LevelDetector, LevelLaw, Param, Place,
    Samples, Value, Values, list, number,
};
use crate::numeric::range::{Bounds, ends};

pub struct NoiseVarianceTime;

static PARAMS: [Param; 1] = [Param::reported("ratio", "", 1.0, 1e3)];

/// Scale at instants, against the claimed level.
const KNOT_TIMES: &str = "knots_time_s";
const KNOT_RATIOS: &str = "knots_ratio";

describe! {
    NoiseVarianceTime, "noise_variance_time", Samples in Time, needs [],
    confusers ["outlier_bursts", "noise_variance_rate", "excess_arw"],
    lists [
        Param::inner(KNOT_TIMES, "s", f64::MIN, f64::MAX),
        Param::inner(KNOT_RATIOS, "", 0.0, 1e3)
    ]
}

impl Samples for NoiseVarianceTime {
    /// Without knots the level rises from the claimed one to `ratio` times that over the record.
    fn apply(&self, values: &Values, drivers: &Drivers, _seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        if let Some(knots) = Knots::new(list(values, KNOT_TIMES), list(values, KNOT_RATIOS)) {
            crate::effect::shared::noise_level::scale(drivers, rate, |i| {
                knots.at(drivers.time_s(i)).max(0.0)
            });
        } else if let Some(ratio) = number(values, PARAMS[0].name) {
            let last = drivers.samples.max(2) as f64 - 1.0;
            crate::effect::shared::noise_level::scale(drivers, rate, |i| {
                1.0 + (ratio - 1.0) * i as f64 / last
            });
        }
    }

    fn detector(&self) -> Detector {
        Detector::Level(&NoiseVarianceTime)
    }
}

/// Knots that a claim states of a law which no short list of times describes.
const STATED_KNOTS: usize = 256;

impl LevelDetector for NoiseVarianceTime {
    /// The best form over time, and one over each column but the rate, which is an effect of its own. Averages hold no
    /// angles.
    fn laws(&self, residual: &FlatResidual<'_>, samples: &[usize]) -> Vec<LevelLaw> {
        let mut out: Vec<LevelLaw> = forms::over_time(residual, samples).into_iter().collect();
        for column in Column::ALL {
            let Some(values) = residual.drivers.column(column).filter(|v| ends(v).is_wide()) else {
                continue;
            };
            out.extend(over_column(column, values, residual, samples));
        }
        out
    }

    fn stated(&self, level: &Level, drivers: &Drivers) -> Values {
        let knots = match &level.law {
            Law::Time(knots) => knots.clone(),
            _ => {
                let step = (level.profile.len() / STATED_KNOTS).max(1);
                let knot = |i: usize| Knot { at: drivers.time_s(i), value: level.profile[i] };
                (0..level.profile.len()).step_by(step).map(knot).collect()
            }
        };
        Values::from([
            (KNOT_TIMES.to_owned(), Value::List(knots.iter().map(|k| k.at).collect())),
            (KNOT_RATIOS.to_owned(), Value::List(knots.iter().map(|k| k.value).collect())),
        ])
    }
}

/// The law over the values of a column that the level follows.
fn over_column(
    column: Column,
    values: &[f64],
    residual: &FlatResidual<'_>,
    samples: &[usize],
) -> Option<LevelLaw> {
    let domain = match column {
        Column::Temperature => Domain::Temperature,
        Column::Supply => Domain::Supply,
        Column::OuterRate => Domain::OuterRate,
        _ => return None,
    };
    let (groups, means) = by_value(|i| values[i], residual, samples);
    let Bounds { low, high } = ends(&means);
    if !ends(&means).is_wide() {
        return None;
    }
    let centred = |v: f64| (2.0 * v - low - high) / (high - low);
    let x: Vec<f64> = means.iter().map(|v| centred(*v)).collect();
    let square = |v: &f64| 1.5 * v * v - 0.5;
    let orders = [vec![x.clone()], vec![x.clone(), x.iter().map(square).collect()]];
    let rows = (samples.len() as f64).ln();
    let fits = orders.into_iter().filter_map(|columns| Some((fit(&groups, &columns)?, columns)));
    let (best, columns) = fits.max_by(|a, b| {
        let score = |f: &f64, p: usize| 2.0 * f - p as f64 * rows;
        score(&a.0.gain, a.1.len()).total_cmp(&score(&b.0.gain, b.1.len()))
    })?;
    let (ratio, ci95) = contrast(&best.log_squares, &best.covariance, &columns);
    let knots: Vec<Knot> =
        means.iter().zip(&best.log_squares).map(|(v, l)| Knot { at: *v, value: (0.5 * l).exp() }).collect();
    let Bounds { low: from, high: to } = raised(&means, &best.log_squares);
    let free = columns.len();
    Some(LevelLaw {
        profile: values.iter().map(|v| between(&knots, *v)).collect(),
        law: Law::Column(column, thinned(&knots)),
        gain: best.gain,
        trials: 2.0,
        free,
        parameters: free,
        dispersion: overdispersion(&groups, &best.log_squares, free + 1),
        ratio,
        ci95,
        place: Place { domain, from, to },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::ClaimedMean;

    #[test]
    fn deviations_are_scaled_about_the_claimed_mean() {
        let claim = ClaimedMean { bias_deg_h: 5.0, ..ClaimedMean::default() };
        let drivers = Drivers { dt_s: 1.0, start_s: 100.0, samples: 5, claim, ..Drivers::default() };
        let mut rate = vec![6.0, 4.0, 6.0, 4.0, 6.0];
        let list = |x: &[f64]| Value::List(x.to_vec());
        let values = Values::from([
            (KNOT_TIMES.to_owned(), list(&[100.0, 104.0])),
            (KNOT_RATIOS.to_owned(), list(&[1.0, 3.0])),
        ]);
        NoiseVarianceTime.apply(&values, &drivers, 1, &mut rate, &mut [true; 5]);
        assert_eq!(rate, [6.0, 3.5, 7.0, 2.5, 8.0]);
        let mut rate = vec![6.0; 5];
        let values = Values::from([("ratio".to_owned(), Value::Number(2.0))]);
        NoiseVarianceTime.apply(&values, &drivers, 1, &mut rate, &mut [true; 5]);
        assert_eq!(rate, [6.0, 6.25, 6.5, 6.75, 7.0]);
    }
}
