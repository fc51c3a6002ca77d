//! Bias over temperature: how much, how steep, what the rate of temperature, the lag and the history add, and what the
//! model leaves. Statistics over temperature give every temperature the same weight.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::message::{Arg, Note, note};
use crate::temperature::course::{legendre, legendre_slopes};
use crate::temperature::findings::{Analysis, Findings};
use crate::temperature::lag::{self, AtLag, Coefficient};
use crate::temperature::read::{self, Reading};
use crate::temperature::sampler::Draw;
use nalgebra::DVector;

/// Slope of the bias over temperature.
pub static BIAS_TEMPERATURE_SENSITIVITY: Measurand = Measurand::over_temperature(
    "bias_temperature_sensitivity",
    "deg/h/degC",
    "slope of bias over temperature",
    |m, channel, found| Row { m, channel }.of(found, Row::mean_slope),
)
.signed();

/// Steepest slope of the bias over temperature.
pub static BIAS_TEMPERATURE_SENSITIVITY_MAX: Measurand = Measurand::over_temperature(
    "bias_temperature_sensitivity_max",
    "deg/h/degC",
    "steepest local slope",
    |m, channel, found| Row { m, channel }.of(found, Row::steepest_slope),
)
.signed();

/// Bias per rate of temperature.
pub static BIAS_TEMPERATURE_RATE_SENSITIVITY: Measurand = Measurand::over_temperature(
    "bias_temperature_rate_sensitivity",
    "deg/h/(degC/min)",
    "bias per rate of temperature (Shupe)",
    |m, channel, found| Row { m, channel }.of(found, Row::rate_sensitivity),
)
.signed();

/// Delay between the temperature sensor and the coil.
pub static THERMAL_LAG: Measurand = Measurand::over_temperature(
    "thermal_lag",
    "s",
    "delay between temperature sensor and coil",
    |m, channel, found| Row { m, channel }.of(found, Row::lag),
);

/// What the history of the temperature adds.
pub static THERMAL_HYSTERESIS: Measurand = Measurand::over_temperature(
    "thermal_hysteresis",
    "deg/h",
    "largest gap between the heating and the cooling branch that no rate of temperature explains",
    |m, channel, found| Row { m, channel }.of(found, Row::hysteresis),
)
.signed();

/// Range of the bias over temperature.
pub static BIAS_OVER_TEMPERATURE_PEAK_TO_PEAK: Measurand = Measurand::over_temperature(
    "bias_over_temperature_peak_to_peak",
    "deg/h",
    "range of bias over temperature",
    |m, channel, found| Row { m, channel }.of(found, |row, a| row.range(a, 1.0, peak_to_peak)),
);

/// Root mean square of the bias over temperature.
pub static BIAS_OVER_TEMPERATURE_RMS: Measurand = Measurand::over_temperature(
    "bias_over_temperature_rms",
    "deg/h",
    "rms of bias about its mean over temperature (one sigma)",
    |m, channel, found| Row { m, channel }.of(found, |row, a| row.range(a, 1.0, rms)),
);

/// Three times the root mean square of the bias over temperature.
pub static BIAS_OVER_TEMPERATURE_3SIGMA: Measurand = Measurand::over_temperature(
    "bias_over_temperature_3sigma",
    "deg/h",
    "three times that rms",
    |m, channel, found| Row { m, channel }.of(found, |row, a| row.range(a, 3.0, rms)),
);

/// Gap between heating and cooling.
pub static BIAS_LOOP_WIDTH: Measurand = Measurand::over_temperature(
    "bias_loop_width",
    "deg/h",
    "largest gap between heating and cooling at the rate of the ramps, whatever its cause",
    |m, channel, found| Row { m, channel }.of(found, Row::loop_width),
)
.signed();

/// What the temperature model leaves.
pub static BIAS_RESIDUAL_RMS: Measurand = Measurand::over_temperature(
    "bias_residual_rms",
    "deg/h",
    "rms left after the temperature model",
    |m, channel, found| Row { m, channel }.of(found, Row::residual),
);

/// Rate of every ramp.
pub static RAMP_RATE: Measurand =
    Measurand::over_temperature("ramp_rate", "degC/h", "rate of a temperature ramp", ramps).signed();

/// N in every temperature zone.
pub static ANGLE_RANDOM_WALK_AT_TEMPERATURE: Measurand = Measurand::over_temperature(
    "angle_random_walk_at_temperature",
    "deg/sqrt(h)",
    "N in one temperature zone",
    zones,
);

/// Name of the method of rows that come from the model over temperature.
const METHOD: &str = "thermal_gls";
/// Probability of no lag below which a lag counts as seen. What is stated then excludes none, so that it is to be rare among
/// units without one: an interval of 95 % that just misses zero is not enough.
const SEEN: f64 = 0.005;
/// Probability of as large a range by chance from which the curve counts as flat.
const FLAT: f64 = 0.05;
/// Arguments at which a curve over temperature is read.
const POINTS: usize = 81;
/// Share of the range of lags beyond which a lag is not bounded.
const UNBOUNDED: f64 = 0.9;
/// Times its uncertainty without a lag that a coefficient's uncertainty is where lags add to it what is worth saying.
const WIDENED: f64 = 1.5;

/// One ramp a row, its channel named after the temperature channel and its place in the schedule.
fn ramps(m: &Measurand, channel: &str, found: &Findings) -> Vec<Estimate> {
    let Some(schedule) = &found.schedule else { return vec![] };
    let ramps = schedule.segments.iter().filter(|s| s.kind.is_ramp()).enumerate();
    ramps
        .map(|(i, s)| {
            let spread = Spread::Normal { standard_uncertainty: s.rate_uncertainty_deg_c_h };
            let name = format!("{channel}@ramp{}", i + 1);
            m.measured(&name, s.rate_deg_c_h, spread, "theil_sen").note(note!(
                "thermal.ramp",
                from_h = Arg::figures(s.from_s / 3600.0, 4),
                to_h = Arg::figures(s.to_s / 3600.0, 4)
            ))
        })
        .collect()
}

fn zones(m: &Measurand, channel: &str, found: &Findings) -> Vec<Estimate> {
    const METHOD: &str = "second_differences";
    let one = |z: &crate::temperature::zones::Zone| {
        let name = format!("{channel}@{}", z.deg_c);
        match &z.n {
            Some(n) if z.by_slow_noise => {
                let limit = n.spread.bound(n.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
                m.not_identifiable(&name, limit, METHOD)
                    .note(note!("thermal.zone_slow", average_s = z.average_s))
            }
            Some(n) => {
                let e = m
                    .measured(&name, n.value, n.spread.clone(), METHOD)
                    .note(note!("thermal.zone", average_s = z.average_s));
                // A part that rounds to nothing is not worth a word.
                if z.slow_share < 0.005 {
                    return e;
                }
                let percent = Arg::figures(100.0 * z.slow_share, 2);
                e.note(note!("thermal.zone_without_slow", percent))
            }
            None => m.not_identifiable(&name, None, METHOD).note(note!("thermal.zone_empty")),
        }
    };
    found.zones.iter().map(one).collect()
}

/// A row of a measurand that comes from the model over temperature.
struct Row<'a> {
    m: &'a Measurand,
    channel: &'a str,
}

impl Row<'_> {
    /// The result of `of` for the model, or the reason why there is none.
    fn of(&self, found: &Findings, of: fn(&Self, &Analysis) -> Estimate) -> Vec<Estimate> {
        vec![match &found.analysis {
            Some(analysis) => of(self, analysis),
            None => self.none(None).note(note!("thermal.no_course")),
        }]
    }

    fn mean_slope(&self, a: &Analysis) -> Estimate {
        let p = &a.posterior;
        let reading = read::linear(&p.draws, |d| {
            // The line of least squares over temperature, weights even: the first Legendre coefficient alone.
            let mut w = DVector::zeros(d.coefficients.len());
            w[0] = 2.0 / (p.span.high - p.span.low);
            w
        });
        self.measured(reading).note(self.model_note(a))
    }

    fn steepest_slope(&self, a: &Analysis) -> Estimate {
        let p = &a.posterior;
        let order = p.terms.order;
        let at = steepest(a);
        // The steepest place may change its side from draw to draw; its sign is that of the best fit.
        let reading = read::nonlinear(&p.draws, |_, c| {
            let slopes = grid().map(|x| slope(c, order, x, a));
            slopes.max_by(|x, y| x.abs().total_cmp(&y.abs())).unwrap_or(0.0).abs()
        });
        let sign = slope(&p.best.fitted.solved.coefficients, order, at, a).signum();
        let note = note!("thermal.steepest", deg_c = Arg::figures(p.span.temperature(at), 3));
        self.measured(reading.scaled(sign)).note(note)
    }

    fn measured(&self, r: Reading) -> Estimate {
        self.m.measured(self.channel, r.value, r.spread, METHOD)
    }

    fn none(&self, upper_limit: Option<UpperLimit>) -> Estimate {
        self.m.not_identifiable(self.channel, upper_limit, METHOD)
    }

    /// A number that says how far from flat the curve is: near zero noise makes it, and only a bound can be given.
    fn range(&self, a: &Analysis, times: f64, of: fn(&DVector<f64>, usize) -> f64) -> Estimate {
        let draws = &a.posterior.draws;
        let of = |c: &DVector<f64>| of(c, a.posterior.terms.order);
        if read::by_chance(draws, of) > FLAT {
            let drawn = read::of_draws(draws, |_, c| times * of(c));
            let limit =
                drawn.spread.bound(drawn.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
            return self.none(limit).note(note!("thermal_flat.curve")).note(self.span_note(a));
        }
        let reading = positive(read::nonlinear(draws, |_, c| of(c))).scaled(times);
        self.measured(reading).note(self.span_note(a))
    }

    fn span_note(&self, a: &Analysis) -> Note {
        note!(
            "thermal.span",
            low = Arg::figures(a.posterior.span.low, 3),
            high = Arg::figures(a.posterior.span.high, 3)
        )
    }

    fn model_note(&self, a: &Analysis) -> Note {
        // The draws hold higher orders too, the table and this sentence one.
        let order = a.order;
        match a.orders.iter().find(|t| t.order == order) {
            Some(t) => {
                note!("thermal.order", order, rms = Arg::figures(t.held_out_rms, 3))
            }
            None => note!("thermal.order_fixed", order),
        }
    }

    fn loop_width(&self, a: &Analysis) -> Estimate {
        if !a.both_ways {
            return self.none(None).note(note!("thermal.one_way"));
        }
        let best = best_draw(a);
        let widest = inner_grid()
            .max_by(|x, y| {
                gap(&best, &best.coefficients, *x, a)
                    .abs()
                    .total_cmp(&gap(&best, &best.coefficients, *y, a).abs())
            })
            .unwrap_or(0.0);
        // At the place where the best fit is widest: a maximum over places would grow with the noise.
        let reading = read::nonlinear(&a.posterior.draws, |d, c| gap(d, c, widest, a));
        let note = note!(
            "thermal.loop",
            deg_c = Arg::figures(a.posterior.span.temperature(widest), 3),
            rate = Arg::figures(60.0 * a.ramp_deg_c_min, 3)
        );
        self.measured(reading).note(note)
    }

    fn rate_sensitivity(&self, a: &Analysis) -> Estimate {
        if a.posterior.terms.rate_at().is_none() {
            return self.none(None).note(note!("thermal.one_way"));
        }
        if !a.parted {
            return self.none(None).note(inseparable(a));
        }
        if a.narrow() {
            return self.none(None).note(narrow(a));
        }
        self.beside_a_lag(a, 1.0, |l| l.rate)
    }

    fn hysteresis(&self, a: &Analysis) -> Estimate {
        if a.posterior.terms.hysteresis_at().is_none() {
            return self.none(None).note(note!("thermal.one_way"));
        }
        if !a.parted {
            return self.none(None).note(inseparable(a));
        }
        self.beside_a_lag(a, 2.0, |l| l.hysteresis)
    }

    /// A coefficient whose interval holds every lag that explains the record as well. Where no lag is shown, the value is
    /// that without one.
    fn beside_a_lag(&self, a: &Analysis, times: f64, of: fn(&AtLag) -> Option<Coefficient>) -> Estimate {
        let lags = &a.posterior.lags;
        let mut reading = lag::coefficient(lags, of);
        let told = Lag::of(a);
        let (true, Some((without, deviation))) = (told.may_be_none, lag::at_shortest(lags, of)) else {
            return self.measured(reading.scaled(times)).note(separation_note(a));
        };
        let single = reading.standard_uncertainty() < WIDENED * deviation;
        if let Some(i) = reading.spread.interval(reading.value, 0.95) {
            reading.value = without.clamp(i.low, i.high);
        }
        let row = self.measured(reading.scaled(times));
        if single && told.bounded {
            return row.note(separation_note(a));
        }
        row.note(note!(
            "thermal.lag_or_rate",
            u = Arg::figures(times * deviation, 2),
            lag = Arg::figures(told.longest_s / 60.0, 2)
        ))
    }

    fn lag(&self, a: &Analysis) -> Estimate {
        if a.parted && a.narrow() {
            return self.none(None).note(narrow(a));
        }
        let told = Lag::of(a);
        let limit = told.bounded.then_some(UpperLimit { value: told.upper_s, coverage: 0.95 });
        if !a.parted {
            return self.none(limit).note(inseparable(a));
        }
        if !told.bounded {
            let longest = Arg::figures(told.longest_s / 60.0, 2);
            return self.none(None).note(note!("thermal.any_lag", lag = longest));
        }
        if told.may_be_none {
            return self.none(limit).note(note!("thermal.no_lag"));
        }
        self.measured(told.reading).note(separation_note(a))
    }

    fn residual(&self, a: &Analysis) -> Estimate {
        let spread = Spread::ChiSquare { dof: a.residual_dof };
        let mut e = self
            .m
            .measured(self.channel, a.residual_rms, spread, METHOD)
            .note(note!("thermal.residual", average_s = Arg::figures(a.average_s, 4)));
        let order = a.order;
        if let Some(t) = a.orders.iter().find(|t| t.order == order) {
            e = e.note(note!(
                "thermal.held_out",
                rms = Arg::figures(t.held_out_rms, 3),
                average_s = Arg::figures(t.average_s, 3)
            ));
        }
        e
    }
}

/// Arguments of the polynomial over the whole range.
fn grid() -> impl Iterator<Item = f64> {
    (0..POINTS).map(|i| 2.0 * i as f64 / (POINTS - 1) as f64 - 1.0)
}

/// Without the tenths at the ends, where branches turn round.
fn inner_grid() -> impl Iterator<Item = f64> {
    grid().filter(|x| x.abs() <= 0.8)
}

fn value(c: &DVector<f64>, order: usize, x: f64) -> f64 {
    legendre(x, order).iter().zip(c.iter()).map(|(b, c)| b * c).sum()
}

fn slope(c: &DVector<f64>, order: usize, x: f64, a: &Analysis) -> f64 {
    let p = &a.posterior.span;
    legendre_slopes(x, order).iter().zip(c.iter()).map(|(b, c)| b * c).sum::<f64>() * 2.0 / (p.high - p.low)
}

fn steepest(a: &Analysis) -> f64 {
    let c = &a.posterior.best.fitted.solved.coefficients;
    let order = a.posterior.terms.order;
    grid().max_by(|x, y| slope(c, order, *x, a).abs().total_cmp(&slope(c, order, *y, a).abs())).unwrap_or(0.0)
}

/// Highest less lowest value.
fn peak_to_peak(c: &DVector<f64>, order: usize) -> f64 {
    let values = grid().map(|x| value(c, order, x));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    high - low
}

/// Root of the mean square about the mean, each temperature with the same weight: Σ cₖ²/(2k + 1).
fn rms(c: &DVector<f64>, order: usize) -> f64 {
    let square: f64 =
        c.iter().take(order).enumerate().map(|(k, c)| c * c / (2.0 * (k + 1) as f64 + 1.0)).sum();
    square.sqrt()
}

/// A reading of what cannot be negative.
fn positive(r: Reading) -> Reading {
    let spread = match r.spread {
        Spread::Curve(points) => Spread::Curve(points.into_iter().map(|(z, v)| (z, v.max(0.0))).collect()),
        other => other,
    };
    Reading { value: r.value.max(0.0), spread }
}

fn best_draw(a: &Analysis) -> Draw {
    let b = &a.posterior.best;
    Draw {
        shape: vec![b.shape.lag_s, b.shape.play_deg_c],
        noise: b.fitted.noise,
        coefficients: b.fitted.solved.coefficients.clone(),
        covariance: b.fitted.solved.covariance.clone(),
    }
}

/// Heating less cooling at one temperature of the sensor, at the rate r of the ramps: 2 (D r − b'(T) τ r + h).
fn gap(draw: &Draw, c: &DVector<f64>, x: f64, a: &Analysis) -> f64 {
    let terms = &a.posterior.terms;
    let r = a.ramp_deg_c_min;
    let of = |at: Option<usize>| at.and_then(|i| c.get(i)).copied().unwrap_or(0.0);
    let lag_min = draw.shape.first().copied().unwrap_or(0.0) / 60.0;
    2.0 * (of(terms.rate_at()) * r - slope(c, terms.order, x, a) * lag_min * r + of(terms.hysteresis_at()))
}

/// What a record says of its lag.
struct Lag {
    reading: Reading,
    /// Upper limit with 95 %, s.
    upper_s: f64,
    /// Longest lag that was looked at, s.
    longest_s: f64,
    /// True when the record bounds it from above.
    bounded: bool,
    /// True when the record is explained without one.
    may_be_none: bool,
}

impl Lag {
    fn of(a: &Analysis) -> Lag {
        let longest_s = a.posterior.longest_lag_s;
        let reading = lag::reading(&a.posterior.lags);
        let bound = |p: f64, otherwise: f64| reading.spread.bound(reading.value, p).unwrap_or(otherwise);
        let (lower, upper_s) = (bound(SEEN, 0.0), bound(0.95, longest_s));
        Lag {
            upper_s,
            longest_s,
            bounded: upper_s < UNBOUNDED * longest_s,
            may_be_none: lower <= 1e-3 * a.course.block_s,
            reading,
        }
    }
}

/// How well the terms were distinguished.
fn separation_note(a: &Analysis) -> Note {
    let s = a.separation;
    let inflation = |f: fn(crate::temperature::separate::Separation) -> f64| {
        Arg::figures(s.map_or(f64::INFINITY, f).min(1e6), 2)
    };
    note!(
        "thermal.separation",
        rate = inflation(|s| s.rate),
        lag = inflation(|s| s.lag),
        hysteresis = inflation(|s| s.hysteresis)
    )
}

/// Why a narrow range tells neither the lag nor the sensitivity to the rate of temperature.
fn narrow(a: &Analysis) -> Note {
    let span = a.posterior.span;
    note!(
        "thermal.narrow",
        range = Arg::figures(span.high - span.low, 3),
        crossing = Arg::figures(a.crossing_s() / 60.0, 2),
        lag = Arg::figures(a.posterior.longest_lag_s / 60.0, 2)
    )
}

/// What can be said in place of terms that the schedule does not tell apart: the half gap at the middle of the range,
/// and the ramps that would tell.
fn inseparable(a: &Analysis) -> Note {
    let half = read::nonlinear(&a.posterior.draws, |d, c| 0.5 * gap(d, c, 0.0, a));
    let r = 60.0 * a.ramp_deg_c_min;
    let other = if r > 12.0 { r / 3.0 } else { 3.0 * r };
    note!(
        "thermal.inseparable",
        half_gap = Arg::figures(half.value, 3),
        u = Arg::figures(half.standard_uncertainty(), 2),
        deg_c = Arg::figures(a.posterior.span.temperature(0.0), 3),
        rate = Arg::figures(r, 3),
        other = Arg::figures(other, 2)
    )
}

#[cfg(test)]
#[path = "temperature_tests.rs"]
mod tests;
