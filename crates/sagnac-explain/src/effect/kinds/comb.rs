//! A periodic disturbance with harmonics, of one cause; or one that repeats with the phase of a recorded ramp.

use crate::effect::mean::first;
use crate::effect::shared::phase::Phase;
use crate::effect::shared::polynomial::{Scale, sum};
use crate::effect::shared::reach::varies;
use crate::effect::shared::response::{CENTER_NAME, COEFFICIENTS_LIST, HALF_RANGE};
use crate::effect::shared::search::gain_of;
use crate::effect::shared::sinusoid::{self, LineGains};
use crate::effect::{
    COLUMN_TEXT, Column, Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values,
    list, number, text,
};
use crate::numeric::order::SortByNumber;
use crate::numeric::range::Bounds;

pub struct Comb;

static PARAMS: [Param; 3] = [
    Param::reported("fundamental_hz", "Hz", 0.0, 1e6),
    Param::inner(CENTER_NAME, "", -1e12, 1e12),
    Param::inner(HALF_RANGE, "", 1e-12, 1e12),
];

/// Name of the list of harmonics.
const HARMONICS_LIST: &str = "harmonics";

describe! {
    Comb, "comb", Mean in Frequency, needs [],
    confusers [Line, QuasiPeriodic, ResetRipple, TableHarmonic],
    lists [
        Param::inner(HARMONICS_LIST, "", 1.0, 24.0),
        Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)
    ],
    texts [COLUMN_TEXT],
    properties [carried_over, free_form]
}

/// Highest harmonic.
const MAX_HARMONIC: usize = 24;
/// Number of the lowest harmonics of which [`MIN_LOW_HARMONICS`] must be present: two lines far up have many fundamentals in common
/// by chance.
const LOW_HARMONICS: usize = 3;
/// Fewest of the lowest harmonics.
const MIN_LOW_HARMONICS: usize = 2;
/// Gain of a line some tens of frequency cells away, as a share of its own.
const LEAKAGE_SHARE: f64 = 1e-3;
/// Smallest gain of a harmonic below the highest that pays for itself, nats: that of its two parameters by AIC.
const MIN_GAIN_BELOW_HIGHEST: f64 = 2.0;
/// Fewest periods in the record: slower ones are slow processes.
const MIN_PERIODS: f64 = 8.0;
/// Fewest samples of a record in which a comb is sought.
const MIN_SAMPLES: usize = 256;

/// Harmonics, one bit each, the fundamental in the lowest.
fn harmonics(mask: f64) -> impl Iterator<Item = u32> {
    let mask = mask as u32;
    (0..MAX_HARMONIC as u32).filter(move |h| mask & (1 << h) != 0).map(|h| h + 1)
}

/// True where a set of harmonics belongs to one fundamental and is no line alone.
fn is_comb(mask: u32) -> bool {
    (mask & ((1 << LOW_HARMONICS) - 1)).count_ones() as usize >= MIN_LOW_HARMONICS
}

/// The phase of a column that is a ramp which is reset.
fn phase(column: usize, drivers: &Drivers) -> Option<(Phase, Scale)> {
    let values = &drivers.others.get(column)?.values;
    let scale = Scale::of(values);
    Some((Phase::of(values, scale)?, scale))
}

fn columns(fundamental_hz: f64, orders: &[u32], drivers: &Drivers) -> Vec<Vec<f64>> {
    orders.iter().flat_map(|h| sinusoid::columns(f64::from(*h) * fundamental_hz, drivers)).collect()
}

/// A shape, from its nonlinear parameters.
enum Shape {
    /// A period in time.
    Time { fundamental_hz: f64, orders: Vec<u32> },
    /// The period of a recorded ramp.
    Ramp { column: usize, orders: Vec<u32> },
}

impl Shape {
    fn of(nonlinear_parameters: &[f64]) -> Option<Shape> {
        let [fundamental_hz, mask, column] = *nonlinear_parameters else { return None };
        let orders = harmonics(mask).collect();
        Some(match column as usize {
            0 => Shape::Time { fundamental_hz, orders },
            i => Shape::Ramp { column: i - 1, orders },
        })
    }

    fn columns(&self, drivers: &Drivers) -> Vec<Vec<f64>> {
        match self {
            Shape::Time { fundamental_hz, orders } => columns(*fundamental_hz, orders, drivers),
            Shape::Ramp { column, orders } => phase(*column, drivers)
                .map_or_else(Vec::new, |(p, _)| orders.iter().flat_map(|h| p.harmonic(*h)).collect()),
        }
    }
}

/// Price of a harmonic, nats: that of one parameter by BIC.
fn price(drivers: &Drivers) -> f64 {
    0.5 * (drivers.samples.max(2) as f64).ln()
}

/// Price of a harmonic, nats, whose fundamental is free as well. One above the lowest is chosen among all harmonics, and among the
/// frequencies that the lowest cannot tell apart: without this, noise far up would move the fundamental to itself.
fn price_of_order(order: usize, drivers: &Drivers) -> f64 {
    let choices = if order > LOW_HARMONICS { MAX_HARMONIC * order / LOW_HARMONICS } else { 1 };
    price(drivers) + (choices as f64).ln()
}

/// A comb with its gain less the price of its harmonics.
struct Candidate {
    point: Vec<f64>,
    score: f64,
}

/// The best comb in time: at each fundamental, the harmonics that pay for their parameter.
fn in_time(drivers: &Drivers, context: &SearchContext<'_>, bounds: Bounds) -> Option<Candidate> {
    let LineGains { gains, step_hz } = LineGains::of(drivers, context);
    let prices: Vec<f64> = (0..=MAX_HARMONIC).map(|h| price_of_order(h, drivers)).collect();
    // A fundamental is met to half a cell of its highest harmonic.
    let fine = step_hz / MAX_HARMONIC as f64;
    let (first, last) = ((bounds.low / fine).ceil() as usize, (bounds.high / fine) as usize);
    let cell = |i: usize, h: usize| (h * i + MAX_HARMONIC / 2) / MAX_HARMONIC;
    let mut best = (0.0, 0);
    for i in first..=last {
        let paid = |h: usize| gains.get(cell(i, h)).map(|gain| (gain - prices[h]).max(0.0));
        let lowest = (1..=LOW_HARMONICS).filter(|h| paid(*h).is_some_and(|w| w > 0.0)).count();
        if lowest < MIN_LOW_HARMONICS {
            continue;
        }
        let total = (1..=MAX_HARMONIC).map_while(paid).sum::<f64>();
        if total > best.0 {
            best = (total, i);
        }
    }
    let (best_score, i) = best;
    let gain = |h: usize| gains.get(cell(i, h)).copied().unwrap_or(0.0);
    let largest = (1..=MAX_HARMONIC).map(gain).fold(0.0, f64::max);
    // A strong line leaks into every cell, by less the farther it is.
    let leaked = LEAKAGE_SHARE * largest;
    let highest = (1..=MAX_HARMONIC).filter(|h| gain(*h) > prices[*h].max(leaked)).max().unwrap_or(0);
    // Below the highest one that pays, those too weak to pay still carry their share of the disturbance.
    let present = |h: &usize| *h <= highest && gain(*h) > MIN_GAIN_BELOW_HIGHEST.max(leaked);
    let mask = (1..=MAX_HARMONIC).filter(present).fold(0u32, |mask, h| mask | 1 << (h - 1));
    let point = vec![(i as f64 * fine).clamp(bounds.low, bounds.high), f64::from(mask), 0.0];
    (best_score > 0.0 && is_comb(mask)).then_some(Candidate { point, score: best_score })
}

/// The comb over the phase of a recorded ramp.
fn over_ramp(column: usize, drivers: &Drivers, context: &SearchContext<'_>) -> Option<Candidate> {
    let (phase, _) = phase(column, drivers)?;
    let price = price(drivers);
    // Beyond half a period a sample a harmonic is another one's alias.
    let highest = ((0.5 / phase.typical_step().max(1e-9)) as usize).min(MAX_HARMONIC);
    let (mut mask, mut score) = (0u32, 0.0);
    for order in 1..=highest as u32 {
        let columns = phase.harmonic(order);
        let gain = gain_of(Regressors::columns(columns), context);
        if gain > price {
            mask |= 1 << (order - 1);
            score += gain - price;
        }
    }
    let fundamental = phase.periods() / drivers.length_s();
    let point = vec![fundamental, f64::from(mask), (column + 1) as f64];
    is_comb(mask).then_some(Candidate { point, score })
}

impl MeanModel for Comb {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= MIN_SAMPLES
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let n = drivers.samples;
        if n < MIN_SAMPLES || !context.is_of(n) {
            return Starts::none();
        }
        let ramps = (0..drivers.others.len()).filter(|i| varies(Some(&drivers.others[*i].values)));
        let mut found: Vec<Candidate> = ramps.filter_map(|i| over_ramp(i, drivers, context)).collect();
        found.extend(in_time(drivers, context, self.bounds(drivers)[0]));
        found.sort_descending_by(|a| a.score);
        let within = |f: &Candidate| f.point.iter().zip(self.bounds(drivers)).all(|(x, b)| b.contains(*x));
        let points = found.into_iter().filter(within).take(2).map(|f| f.point).collect();
        Starts { points, trials: (n * MAX_HARMONIC) as f64 }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let slowest = MIN_PERIODS / drivers.length_s();
        // The second harmonic is below half the sample rate.
        let fastest = (0.25 / drivers.dt_s - 0.5 / drivers.length_s()).max(slowest);
        let masks = (1u64 << MAX_HARMONIC) as f64;
        vec![
            Bounds::new(slowest, fastest),
            Bounds::new(0.0, masks),
            Bounds::new(0.0, drivers.others.len() as f64),
        ]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let shape = Shape::of(nonlinear_parameters);
        Regressors::columns(shape.into_iter().flat_map(|shape| shape.columns(drivers)))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let scale = match Shape::of(nonlinear_parameters) {
            Some(Shape::Ramp { column, .. }) => phase(column, drivers).map(|(_, scale)| scale),
            _ => None,
        };
        vec![
            first(nonlinear_parameters),
            scale.map_or(f64::NAN, |s| s.center),
            scale.map_or(f64::NAN, |s| s.half),
        ]
    }

    fn lists(
        &self,
        nonlinear_parameters: &[f64],
        coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        let mask = nonlinear_parameters.get(1).copied().unwrap_or(0.0);
        vec![
            (HARMONICS_LIST, harmonics(mask).map(f64::from).collect()),
            (COEFFICIENTS_LIST, coefficients.to_vec()),
        ]
    }

    fn texts(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<(&'static str, String)> {
        let Some(Shape::Ramp { column, .. }) = Shape::of(nonlinear_parameters) else { return vec![] };
        drivers.others.get(column).map(|o| (COLUMN_TEXT, o.column.name().to_owned())).into_iter().collect()
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let orders: Vec<u32> = list(values, HARMONICS_LIST).iter().map(|h| *h as u32).collect();
        let coefficients = list(values, COEFFICIENTS_LIST);
        if orders.is_empty() || coefficients.len() != 2 * orders.len() {
            return None;
        }
        let columns = match text(values, COLUMN_TEXT) {
            Some(name) => {
                let column = Column::of_name(name);
                let driver = drivers.others.iter().find(|o| o.column == column)?;
                let scale = Scale { center: number(values, CENTER_NAME)?, half: number(values, HALF_RANGE)? };
                let phase = Phase::of(&driver.values, scale)?;
                orders.iter().flat_map(|h| phase.harmonic(*h)).collect()
            }
            None => columns(number(values, PARAMS[0].name)?, &orders, drivers),
        };
        Some(sum(coefficients, &columns))
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let [fundamental, mask, _] = *nonlinear_parameters else { return vec![] };
        let half = 0.5 / drivers.length_s();
        let highest = harmonics(mask).last().unwrap_or(1);
        let to = f64::from(highest) * fundamental + half;
        vec![Place { domain: Domain::Frequency, from: (fundamental - half).max(0.0), to }]
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        vec![0.05 / drivers.length_s(), 1.0, 1.0]
    }

    /// The amplitudes of harmonics are of one size, and only their phases are free: two modes tell of each, not all rows.
    fn bic_parameters(&self, columns: usize) -> usize {
        columns.div_ceil(2)
    }

    fn whole(&self) -> &'static [usize] {
        &[1, 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::OtherDriver;
    use crate::numeric::cosine::dct2;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const SIGMA: f64 = 0.2;

    /// Starts for white noise with what is added to it.
    fn starts(added: impl Fn(f64) -> f64, drivers: &Drivers) -> Vec<Vec<f64>> {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        let n = drivers.samples;
        let noise = (0..n).map(|_| -> f64 { StandardNormal.sample(&mut rng) });
        let residual: Vec<f64> =
            noise.enumerate().map(|(i, e)| SIGMA * e + added(i as f64 * drivers.dt_s)).collect();
        let score: Vec<f64> = residual.iter().map(|r| r / (SIGMA * SIGMA)).collect();
        let (modes, powers) = (dct2(&residual), vec![SIGMA * SIGMA; n]);
        let context = SearchContext { score: &score, modes: &modes, powers: &powers };
        Comb.starts(drivers, &context).points
    }

    fn drivers() -> Drivers {
        Drivers { dt_s: 0.1, samples: 12_000, averaged: 1, ..Drivers::default() }
    }

    #[test]
    fn strokes_that_ring_off_are_one_comb_and_a_line_is_none() {
        let period = 4.37;
        let found = starts(|t| (-(t / period).fract() * period / 0.3).exp(), &drivers());
        let [fundamental, mask, column] = found[0][..] else { panic!("{found:?}") };
        assert!((fundamental - 1.0 / period).abs() < 0.1 / 1200.0, "{found:?}");
        assert!(
            harmonics(mask).count() >= 5 && harmonics(mask).next() == Some(1) && column == 0.0,
            "{found:?}"
        );
        assert!(starts(|t| (1.3 * t).sin(), &drivers()).is_empty());
        // In noise alone, two harmonics that happen to be large: the p-value counts every fundamental for that.
        assert!(starts(|_| 0.0, &drivers()).iter().all(|point| harmonics(point[1]).count() <= 3));
    }

    #[test]
    fn a_ramp_that_wanders_folds_what_time_does_not() {
        // The period changes by a tenth and back: no line, and every harmonic of the phase is sharp.
        let turns = |t: f64| t / 4.0 + 2.0 * (t / 90.0).sin();
        let ramp: Vec<f64> = (0..12_000).map(|i| 300.0 * turns(f64::from(i) * 0.1).rem_euclid(1.0)).collect();
        let other =
            OtherDriver { column: Column::of_name("ramp_counts"), smooth: ramp.clone(), values: ramp };
        let with_ramp = Drivers { others: vec![other], ..drivers() };
        let found = starts(|t| (-turns(t).rem_euclid(1.0) / 0.07).exp(), &with_ramp);
        let [_, mask, column] = found[0][..] else { panic!("{found:?}") };
        assert!(column == 1.0 && harmonics(mask).count() >= 5, "{found:?}");
        assert_eq!(Comb.texts(&found[0], &with_ramp), [("column", "ramp_counts".to_owned())]);
    }

    #[test]
    fn two_harmonics_far_up_are_no_comb() {
        assert!(is_comb(0b11) && is_comb(0b101) && is_comb(0b110));
        assert!(!is_comb(0b1) && !is_comb(0b1_1000) && !is_comb(0b1001));
    }
}
