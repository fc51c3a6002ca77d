//! Bias over temperature: how much, how steep, what the rate of temperature, the lag and the history add, and what the
//! model leaves. Statistics over temperature give every temperature the same weight.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::ids;
use crate::message::{Arg, Note};
use crate::temperature::course::{legendre, legendre_slopes};
use crate::temperature::findings::{Analysis, Findings};
use crate::temperature::lag::{self, AtLag, Coefficient};
use crate::temperature::read::{self, Reading};
use crate::temperature::sampler::Draw;
use nalgebra::DVector;

pub(super) struct OverTemperature;

const IDS: &[&str] = &[
    "bias_temperature_sensitivity",
    "bias_temperature_sensitivity_max",
    "bias_temperature_rate_sensitivity",
    "thermal_lag",
    "thermal_hysteresis",
    "bias_over_temperature_peak_to_peak",
    "bias_over_temperature_rms",
    "bias_over_temperature_3sigma",
    "bias_loop_width",
    "bias_residual_rms",
    "ramp_rate",
    "angle_random_walk_at_temperature",
];

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

impl Measurand for OverTemperature {
    fn ids(&self) -> &'static [&'static str] {
        IDS
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, options: &Options) -> Option<Estimate> {
        self.evaluate_all(id, gyro, options).into_iter().next()
    }

    fn evaluate_all(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Vec<Estimate> {
        gyro.over_temperature.as_ref().map_or_else(Vec::new, |f| over_temperature(id, &gyro.channel, f))
    }
}

/// Every row of a measurand over temperature on a channel.
pub fn over_temperature(id: &str, channel: &str, found: &Findings) -> Vec<Estimate> {
    match id {
        "ramp_rate" => ramps(channel, found),
        "angle_random_walk_at_temperature" => zones(channel, found),
        id => match (&found.analysis, ids::find(id)) {
            (Some(analysis), Some(m)) => {
                Row { id: m.id, unit: m.unit, channel }.of(analysis).into_iter().collect()
            }
            (None, Some(m)) => {
                let none = Estimate::not_identifiable(m.id, channel, None, m.unit, METHOD);
                vec![none.note(Note::new("thermal.no_course"))]
            }
            (_, None) => vec![],
        },
    }
}

/// One ramp a row, its channel named after the temperature channel and its place in the schedule.
fn ramps(channel: &str, found: &Findings) -> Vec<Estimate> {
    let Some(schedule) = &found.schedule else { return vec![] };
    let ramps = schedule.segments.iter().filter(|s| s.kind.is_ramp()).enumerate();
    ramps
        .map(|(i, s)| {
            let spread = Spread::Normal { standard_uncertainty: s.rate_uncertainty_deg_c_h };
            let name = format!("{channel}@ramp{}", i + 1);
            Estimate::measured("ramp_rate", &name, s.rate_deg_c_h, "degC/h", spread, "theil_sen").note(
                Note::new("thermal.ramp")
                    .with("from_h", Arg::figures(s.from_s / 3600.0, 4))
                    .with("to_h", Arg::figures(s.to_s / 3600.0, 4)),
            )
        })
        .collect()
}

fn zones(channel: &str, found: &Findings) -> Vec<Estimate> {
    let id = "angle_random_walk_at_temperature";
    let unit = "deg/sqrt(h)";
    let one = |z: &crate::temperature::zones::Zone| {
        let name = format!("{channel}@{}", z.deg_c);
        match &z.n {
            Some(n) if z.by_slow_noise => {
                let limit = n.spread.bound(n.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
                Estimate::not_identifiable(id, &name, limit, unit, "second_differences")
                    .note(Note::new("thermal.zone_slow").with("average_s", z.average_s))
            }
            Some(n) => {
                let e = Estimate::measured(id, &name, n.value, unit, n.spread.clone(), "second_differences")
                    .note(Note::new("thermal.zone").with("average_s", z.average_s));
                // A part that rounds to nothing is not worth a word.
                if z.slow_share < 0.005 {
                    return e;
                }
                let percent = Arg::figures(100.0 * z.slow_share, 2);
                e.note(Note::new("thermal.zone_without_slow").with("percent", percent))
            }
            None => Estimate::not_identifiable(id, &name, None, unit, "second_differences")
                .note(Note::new("thermal.zone_empty")),
        }
    };
    found.zones.iter().map(one).collect()
}

struct Row<'a> {
    id: &'static str,
    unit: &'static str,
    channel: &'a str,
}

impl Row<'_> {
    fn of(&self, a: &Analysis) -> Option<Estimate> {
        let p = &a.posterior;
        let order = p.terms.order;
        match self.id {
            "bias_temperature_sensitivity" => {
                let reading = read::linear(&p.draws, |d| {
                    // The line of least squares over temperature, weights even: the first Legendre coefficient alone.
                    let mut w = DVector::zeros(d.coefficients.len());
                    w[0] = 2.0 / (p.span.high - p.span.low);
                    w
                });
                Some(self.measured(reading).note(self.model_note(a)))
            }
            "bias_temperature_sensitivity_max" => {
                let at = steepest(a);
                let reading = read::bent(&p.draws, |d, c| {
                    let slopes = grid().map(|x| slope(c, order, x, a));
                    let largest = slopes.max_by(|x, y| x.abs().total_cmp(&y.abs())).unwrap_or(0.0);
                    // The steepest place may change its side from draw to draw; its sign is that of the best fit.
                    let _ = d;
                    largest.abs()
                });
                let sign = slope(&p.best.fitted.solved.coefficients, order, at, a).signum();
                let note =
                    Note::new("thermal.steepest").with("deg_c", Arg::figures(p.span.temperature(at), 3));
                Some(self.measured(reading.scaled(sign)).note(note))
            }
            "bias_over_temperature_peak_to_peak" => Some(self.range(a, 1.0, &|c| {
                let values = grid().map(|x| value(c, order, x));
                let (low, high) =
                    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                high - low
            })),
            "bias_over_temperature_rms" => Some(self.range(a, 1.0, &|c| rms(c, order))),
            "bias_over_temperature_3sigma" => Some(self.range(a, 3.0, &|c| rms(c, order))),
            "bias_loop_width" => self.loop_width(a),
            "bias_temperature_rate_sensitivity" => self.rate_sensitivity(a),
            "thermal_lag" => self.lag(a),
            "thermal_hysteresis" => self.hysteresis(a),
            "bias_residual_rms" => Some(self.residual(a)),
            _ => None,
        }
    }

    fn measured(&self, r: Reading) -> Estimate {
        Estimate::measured(self.id, self.channel, r.value, self.unit, r.spread, METHOD)
    }

    fn none(&self, upper_limit: Option<UpperLimit>) -> Estimate {
        Estimate::not_identifiable(self.id, self.channel, upper_limit, self.unit, METHOD)
    }

    /// A number that says how far from flat the curve is: near zero noise makes it, and only a bound can be given.
    fn range(&self, a: &Analysis, times: f64, of: &dyn Fn(&DVector<f64>) -> f64) -> Estimate {
        let draws = &a.posterior.draws;
        if read::by_chance(draws, of) > FLAT {
            let drawn = read::drawn(draws, |_, c| times * of(c));
            let limit =
                drawn.spread.bound(drawn.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
            return self.none(limit).note(Note::new("thermal_flat.curve")).note(self.span_note(a));
        }
        let reading = positive(read::bent(draws, |_, c| of(c))).scaled(times);
        self.measured(reading).note(self.span_note(a))
    }

    fn span_note(&self, a: &Analysis) -> Note {
        Note::new("thermal.span")
            .with("low", Arg::figures(a.posterior.span.low, 3))
            .with("high", Arg::figures(a.posterior.span.high, 3))
    }

    fn model_note(&self, a: &Analysis) -> Note {
        // The draws hold higher orders too, the table and this sentence one.
        let order = a.order;
        match a.orders.iter().find(|t| t.order == order) {
            Some(t) => {
                Note::new("thermal.order").with("order", order).with("rms", Arg::figures(t.held_out_rms, 3))
            }
            None => Note::new("thermal.order_fixed").with("order", order),
        }
    }

    fn loop_width(&self, a: &Analysis) -> Option<Estimate> {
        if !a.both_ways {
            return Some(self.none(None).note(Note::new("thermal.one_way")));
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
        let reading = read::bent(&a.posterior.draws, |d, c| gap(d, c, widest, a));
        let note = Note::new("thermal.loop")
            .with("deg_c", Arg::figures(a.posterior.span.temperature(widest), 3))
            .with("rate", Arg::figures(60.0 * a.ramp_deg_c_min, 3));
        Some(self.measured(reading).note(note))
    }

    fn rate_sensitivity(&self, a: &Analysis) -> Option<Estimate> {
        if a.posterior.terms.rate_at().is_none() {
            return Some(self.none(None).note(Note::new("thermal.one_way")));
        }
        if !a.parted {
            return Some(self.none(None).note(inseparable(a)));
        }
        if a.narrow() {
            return Some(self.none(None).note(narrow(a)));
        }
        Some(self.beside_a_lag(a, 1.0, |l| l.rate))
    }

    fn hysteresis(&self, a: &Analysis) -> Option<Estimate> {
        if a.posterior.terms.hysteresis_at().is_none() {
            return Some(self.none(None).note(Note::new("thermal.one_way")));
        }
        if !a.parted {
            return Some(self.none(None).note(inseparable(a)));
        }
        Some(self.beside_a_lag(a, 2.0, |l| l.hysteresis))
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
        row.note(
            Note::new("thermal.lag_or_rate")
                .with("u", Arg::figures(times * deviation, 2))
                .with("lag", Arg::figures(told.longest_s / 60.0, 2)),
        )
    }

    fn lag(&self, a: &Analysis) -> Option<Estimate> {
        if a.parted && a.narrow() {
            return Some(self.none(None).note(narrow(a)));
        }
        let told = Lag::of(a);
        let limit = told.bounded.then_some(UpperLimit { value: told.upper_s, coverage: 0.95 });
        if !a.parted {
            return Some(self.none(limit).note(inseparable(a)));
        }
        if !told.bounded {
            let longest = Arg::figures(told.longest_s / 60.0, 2);
            return Some(self.none(None).note(Note::new("thermal.any_lag").with("lag", longest)));
        }
        if told.may_be_none {
            return Some(self.none(limit).note(Note::new("thermal.no_lag")));
        }
        Some(self.measured(told.reading).note(separation_note(a)))
    }

    fn residual(&self, a: &Analysis) -> Estimate {
        let spread = Spread::ChiSquare { dof: a.residual_dof };
        let mut e = Estimate::measured(self.id, self.channel, a.residual_rms, self.unit, spread, METHOD)
            .note(Note::new("thermal.residual").with("average_s", Arg::figures(a.average_s, 4)));
        let order = a.order;
        if let Some(t) = a.orders.iter().find(|t| t.order == order) {
            e = e.note(
                Note::new("thermal.held_out")
                    .with("rms", Arg::figures(t.held_out_rms, 3))
                    .with("average_s", Arg::figures(t.average_s, 3)),
            );
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
    /// What it is at most with 95 %, s.
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

/// How well the terms were told apart.
fn separation_note(a: &Analysis) -> Note {
    let s = a.separation;
    let inflation = |f: fn(crate::temperature::separate::Separation) -> f64| {
        Arg::figures(s.map_or(f64::INFINITY, f).min(1e6), 2)
    };
    Note::new("thermal.separation")
        .with("rate", inflation(|s| s.rate))
        .with("lag", inflation(|s| s.lag))
        .with("hysteresis", inflation(|s| s.hysteresis))
}

/// Why a narrow range tells neither the lag nor the sensitivity to the rate of temperature.
fn narrow(a: &Analysis) -> Note {
    let span = a.posterior.span;
    Note::new("thermal.narrow")
        .with("range", Arg::figures(span.high - span.low, 3))
        .with("crossing", Arg::figures(a.crossing_s() / 60.0, 2))
        .with("lag", Arg::figures(a.posterior.longest_lag_s / 60.0, 2))
}

/// What can be said in place of terms that the schedule does not tell apart: the half gap at the middle of the range,
/// and the ramps that would tell.
fn inseparable(a: &Analysis) -> Note {
    let half = read::bent(&a.posterior.draws, |d, c| 0.5 * gap(d, c, 0.0, a));
    let r = 60.0 * a.ramp_deg_c_min;
    let other = if r > 12.0 { r / 3.0 } else { 3.0 * r };
    Note::new("thermal.inseparable")
        .with("half_gap", Arg::figures(half.value, 3))
        .with("u", Arg::figures(half.standard_uncertainty(), 2))
        .with("deg_c", Arg::figures(a.posterior.span.temperature(0.0), 3))
        .with("rate", Arg::figures(r, 3))
        .with("other", Arg::figures(other, 2))
}
