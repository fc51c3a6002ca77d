//! No or reduced response around zero input rate.

use crate::effect::shared::search::{best_of, fast_level, log_grid, peaks};
use crate::effect::sizing::numbers;
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Values, number,
};
use crate::numeric::order::SortByNumber;
use crate::numeric::range::Bounds;

/// Number of widths that are tried of a zone that shows beyond its edges as well.
const WIDTHS_BEYOND: usize = 16;

pub struct DeadZone;

static PARAMS: [Param; 4] = [
    Param::reported("half_width_deg_h", "deg/h", 0.0, 1e6),
    Param::inner("lost_share", "", 0.0, 1.2),
    // 1: beyond the zone the response stays behind by the half width; 0: it is whole there.
    Param::inner("stays_behind", "", 0.0, 1.0),
    // 1: two beams lock to each other, and beyond the zone their beat is less than the rate.
    Param::inner("lock_in", "", 0.0, 1.0),
];

/// Response beyond the zone, where H is the half width and x the size of the rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// x: a threshold.
    Whole,
    /// x − H: play.
    StaysBehind,
    /// √(x² − H²): lock-in of a ring laser (IEEE Std 647).
    LockIn,
}

impl Form {
    /// All forms; the position of one is its number among the nonlinear parameters.
    const ALL: [Form; 3] = [Form::Whole, Form::StaysBehind, Form::LockIn];

    fn of_number(number: f64) -> Form {
        Form::ALL.get(number.round().max(0.0) as usize).copied().unwrap_or(Form::Whole)
    }

    /// As the parameters of a claim state it.
    fn of_claim(values: &Values) -> Form {
        let is = |param: &Param| number(values, param.name).is_some_and(|b| b > 0.5);
        match (is(&PARAMS[2]), is(&PARAMS[3])) {
            (_, true) => Form::LockIn,
            (true, false) => Form::StaysBehind,
            (false, false) => Form::Whole,
        }
    }

    /// Rate that is lost at a rate, both in deg/h.
    fn lost(self, half_width: f64, rate: f64) -> f64 {
        let size = rate.abs();
        if size < half_width {
            return -rate;
        }
        match self {
            Form::Whole => 0.0,
            Form::StaysBehind => -half_width.copysign(rate),
            Form::LockIn => (size - (size * size - half_width * half_width).sqrt()).copysign(-rate),
        }
    }
}

describe! {
    DeadZone, "dead_zone", Mean in InputRate, needs [TableRate],
    confusers [SfNonlinearity, SfError, Quantization],
    properties [carried_over]
}

/// Rate that is lost, deg/h.
fn column(half_width: f64, form: Form, drivers: &Drivers) -> Option<Vec<f64>> {
    let rate = drivers.table_rate.as_ref()?;
    Some(rate.iter().map(|r| form.lost(half_width, 3600.0 * r)).collect())
}

/// Positions of the samples in the order of the size of their rate, with the sizes, deg/h.
fn by_size(drivers: &Drivers) -> Vec<(f64, usize)> {
    let rates = drivers.table_rate.iter().flatten().enumerate();
    let mut sizes: Vec<(f64, usize)> =
        rates.map(|(i, r)| ((3600.0 * r).abs(), i)).filter(|(s, _)| s.is_finite() && *s > 0.0).collect();
    sizes.sort_ascending_by(|a| a.0);
    sizes
}

/// Largest half width of a zone around zero, as a share of the largest rate.
const MAX_HALF_WIDTH_SHARE: f64 = 0.8;

/// Smallest and largest rate but zero, deg/h, and how many sizes there are.
fn sizes(drivers: &Drivers) -> Option<(f64, f64, usize)> {
    let rates = || drivers.table_rate.iter().flatten().map(|r| (3600.0 * r).abs()).filter(|s| *s > 0.0);
    let (low, high) = rates().fold((f64::INFINITY, 0.0f64), |(a, b), s| (a.min(s), b.max(s)));
    let between = rates().filter(|s| *s > 1.000_001 * low && *s < 0.999_999 * high).count();
    (low.is_finite() && high.is_finite()).then_some((low, high, between))
}

/// Widths that gain most in white noise. Between neighbouring sizes of the rate every width is the same, so that one pass
/// over the sizes in their order sees all of them.
fn widths(drivers: &Drivers, context: &SearchContext<'_>, keep: usize) -> Vec<f64> {
    let order = by_size(drivers);
    let level = fast_level(context);
    let (mut both, mut square, mut sum) = (0.0, 0.0, 0.0);
    let (mut gains, mut middles) = (vec![], vec![]);
    for pair in order.windows(2) {
        let (size, i) = pair[0];
        let z = drivers.table_rate.as_ref().and_then(|r| r.get(i)).map_or(0.0, |r| -3600.0 * r);
        both += z * context.score.get(i).copied().unwrap_or(0.0);
        square += z * z;
        sum += z;
        if pair[1].0 > size * (1.0 + 1e-9) {
            let norm = (square - sum * sum / drivers.samples.max(1) as f64) / level;
            gains.push(if norm > 0.0 { 0.5 * both * both / norm } else { 0.0 });
            middles.push(0.5 * (size + pair[1].0));
        }
    }
    let apart = (gains.len() / 200).max(1);
    peaks(&gains, keep, apart).into_iter().map(|i| middles[i]).collect()
}

impl MeanModel for DeadZone {
    fn applies(&self, drivers: &Drivers) -> bool {
        sizes(drivers).is_some_and(|(_, _, between)| between > 0)
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        if !context.is_of(drivers.samples) {
            return Starts::none();
        }
        let whole = widths(drivers, context, 5).into_iter().map(|w| vec![w, 0.0]);
        let grid = sizes(drivers).map_or(vec![], |(low, high, _)| log_grid(low, high, WIDTHS_BEYOND));
        let points = whole.chain(grid.into_iter().flat_map(|w| [vec![w, 1.0], vec![w, 2.0]]));
        // Widths inside one another share their samples: about as many as ratios of e are apart.
        let trials = sizes(drivers).map_or(1.0, |(_, _, between)| (between as f64).clamp(1.0, 64.0));
        Starts { points: best_of(self, points, 3, drivers, context), trials }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        // A reading that holds at nearly every rate is no zone around zero.
        const FORMS: Bounds = Bounds::new(0.0, (Form::ALL.len() - 1) as f64);
        let around_zero = |high: f64, low: f64| (MAX_HALF_WIDTH_SHARE * high).max(low);
        sizes(drivers).map_or(vec![Bounds::new(1e-9, 1e-9), FORMS], |(low, high, _)| {
            vec![Bounds::new(low, around_zero(high, low)), FORMS]
        })
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let [width, form] = nonlinear_parameters else { return Regressors::default() };
        match Form::of_number(*form) {
            Form::Whole => Regressors::columns(column(*width, Form::Whole, drivers)),
            // The width alone makes it: with a share of its own a narrow zone would only be known by their product.
            beyond => Regressors { offset: column(*width, beyond, drivers), ..Regressors::default() },
        }
    }

    fn whole(&self) -> &'static [usize] {
        &[1]
    }

    fn forms(&self) -> Option<(usize, &'static [f64])> {
        Some((1, &[0.0, 1.0, 2.0]))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        let [width, form] = nonlinear_parameters else { return vec![f64::NAN; PARAMS.len()] };
        let form = Form::of_number(*form);
        let is = |asked: Form| if form == asked { 1.0 } else { 0.0 };
        let share = coefficients.first().copied().unwrap_or(1.0);
        vec![*width, share, is(Form::StaysBehind), is(Form::LockIn)]
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let Some((low, _, between)) = sizes(drivers) else { return vec![] };
        let place = numbers([(PARAMS[1].name, 1.0), (PARAMS[2].name, 0.0), (PARAMS[3].name, 0.0)]);
        vec![Sizing::searched(&PARAMS[0], vec![place], 2, (between as f64).clamp(1.0, 64.0)).from(low)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let share = number(values, PARAMS[1].name).unwrap_or(1.0);
        let column = column(number(values, PARAMS[0].name)?, Form::of_claim(values), drivers)?;
        Some(column.into_iter().map(|x| share * x).collect())
    }

    /// A unit has one zone.
    fn same_cause(&self, _earlier: &[f64], _nonlinear_parameters: &[f64]) -> bool {
        true
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], _drivers: &Drivers) -> Vec<Place> {
        let at = |w: &f64| Place { domain: Domain::InputRate, from: -w / 3600.0, to: w / 3600.0 };
        nonlinear_parameters.first().map(at).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn within_the_zone_all_of_the_rate_is_lost_and_beyond_what_stays_behind() {
        // 0.36, 3.6 and −7.2 deg/h.
        let drivers = Drivers { table_rate: Some(vec![1e-4, 1e-3, -2e-3]), ..Drivers::default() };
        let stated = numbers([("half_width_deg_h", 3.0)]);
        let course = DeadZone.course(&stated, &drivers).unwrap();
        assert!((course[0] + 0.36).abs() < 1e-12 && course[1..] == [0.0, 0.0], "{course:?}");
        let stated = numbers([("half_width_deg_h", 3.0), ("stays_behind", 1.0)]);
        let course = DeadZone.course(&stated, &drivers).unwrap();
        assert!((course[0] + 0.36).abs() < 1e-12 && course[1..] == [-3.0, 3.0], "{course:?}");
        // √(3.6² − 3²) and √(7.2² − 3²) are what is left of 3.6 and 7.2.
        let stated = numbers([("half_width_deg_h", 3.0), ("lock_in", 1.0)]);
        let course = DeadZone.course(&stated, &drivers).unwrap();
        let expected = [-0.36, 3.96f64.sqrt() - 3.6, 7.2 - 42.84f64.sqrt()];
        assert!(course.iter().zip(expected).all(|(c, e)| (c - e).abs() < 1e-12), "{course:?}");
    }

    #[test]
    fn the_width_that_gains_most_ends_the_lost_rates() {
        let rate: Vec<f64> =
            (1..=100).map(|i| if i % 2 == 0 { f64::from(i) } else { -f64::from(i) } / 3600.0).collect();
        let residual: Vec<f64> =
            rate.iter().map(|r| if (3600.0 * r).abs() < 30.5 { -3600.0 * r } else { 0.0 }).collect();
        let drivers = Drivers { dt_s: 1.0, samples: 100, table_rate: Some(rate), ..Drivers::default() };
        let context = SearchContext { score: &residual, modes: &residual, powers: &[1.0; 100] };
        assert!((widths(&drivers, &context, 1)[0] - 30.5).abs() < 1e-9);
    }
}
