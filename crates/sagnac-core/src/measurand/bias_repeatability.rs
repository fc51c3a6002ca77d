//! Repeatability of the bias from switching on to switching on.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::influence::repeatability::{Repeatability, factors};
use crate::message::{Arg, Note};
use crate::numeric::reml::Combination;

/// Standard deviation between switchings-on.
pub static BIAS_REPEATABILITY: Measurand = Measurand::of_runs(
    "bias_repeatability",
    "deg/h",
    "standard deviation of the bias between switchings-on, noise taken out",
    |m, runs| vec![deviation(m, runs)],
)
.also_called(&["br", "repeatability", "run_to_run", "turn_on_to_turn_on"])
.drift();

/// Range of the switchings-on.
pub static BIAS_REPEATABILITY_PEAK_TO_PEAK: Measurand = Measurand::of_runs(
    "bias_repeatability_peak_to_peak",
    "deg/h",
    "largest less smallest bias of the switchings-on",
    |m, runs| vec![peak_to_peak(m, runs)],
)
.drift();

/// Change from the first to the last switching-on.
pub static BIAS_REPEATABILITY_TREND: Measurand = Measurand::of_runs(
    "bias_repeatability_trend",
    "deg/h",
    "change from the first to the last switching-on by the line through all",
    |m, runs| vec![trend(m, runs)],
)
.drift()
.signed();

/// Change with the temperature of the switchings-on.
pub static BIAS_REPEATABILITY_TEMPERATURE: Measurand = Measurand::of_runs(
    "bias_repeatability_temperature",
    "deg/h/degC",
    "change of the bias with the temperature of the switchings-on",
    |m, runs| vec![temperature(m, runs)],
)
.drift()
.signed();

const METHOD: &str = "means_of_runs";

/// Correlation of temperature and order from which it is said that they went in step.
const IN_STEP: f64 = 0.7;

fn deviation(m: &Measurand, runs: &Repeatability) -> Estimate {
    let n = runs.runs.len();
    let (low, high) = factors(n);
    let typical = (runs.runs.iter().map(|r| r.bias.standard.powi(2)).sum::<f64>() / n as f64).sqrt();
    let (value, spread) = runs.deviation.clone();
    let told = Note::new("runs.repeatability")
        .with("n", n)
        .with("low", Arg::figures(low, 2))
        .with("high", Arg::figures(high, 3))
        .with("plain", Arg::figures(runs.plain, 3))
        .with("noise", Arg::figures(typical, 2));
    shown_or_bounded(m, &runs.channel, value, spread, told)
}

fn peak_to_peak(m: &Measurand, runs: &Repeatability) -> Estimate {
    let told =
        Note::new("runs.range").with("n", runs.runs.len()).with("plain", Arg::figures(runs.range.plain, 3));
    shown_or_bounded(m, &runs.channel, runs.range.value, runs.range.spread.clone(), told)
}

fn trend(m: &Measurand, runs: &Repeatability) -> Estimate {
    let n = runs.runs.len();
    match &runs.trend {
        Some(t) => in_step(runs, measured(m, runs, t).note(Note::new("runs.trend").with("n", n))),
        None if n >= 4 => in_step(runs, none(m, runs, "runs.not_apart")),
        None => none(m, runs, "runs.no_line"),
    }
}

fn temperature(m: &Measurand, runs: &Repeatability) -> Estimate {
    match &runs.temperature {
        Some(t) => {
            let note = Note::new("runs.temperature")
                .with("percent", Arg::figures(100.0 * t.share, 2))
                .with("left", Arg::figures(t.left, 3))
                .with("range", Arg::figures(t.range, 2));
            in_step(runs, measured(m, runs, &t.slope).note(note))
        }
        None if runs.in_step.is_some() => in_step(runs, none(m, runs, "runs.not_apart")),
        None => none(m, runs, if runs.runs.len() < 4 { "runs.no_line" } else { "runs.no_temperature" }),
    }
}

fn measured(m: &Measurand, runs: &Repeatability, c: &Combination) -> Estimate {
    let spread = Spread::StudentT { standard_uncertainty: c.standard, dof: c.dof };
    m.measured(&runs.channel, c.value, spread, METHOD)
}

fn none(m: &Measurand, runs: &Repeatability, key: &'static str) -> Estimate {
    m.not_identifiable(&runs.channel, None, METHOD).note(Note::new(key))
}

/// Adds how the temperature went with the order of the runs.
fn in_step(runs: &Repeatability, row: Estimate) -> Estimate {
    match runs.in_step {
        None => row.note(Note::new("runs.trend_alone")),
        Some(r) if r.abs() >= IN_STEP => {
            row.note(Note::new("runs.in_step").with("correlation", Arg::figures(r, 2)))
        }
        Some(_) => row,
    }
}

/// A value whose interval does not reach zero, or a bound.
fn shown_or_bounded(m: &Measurand, channel: &str, value: f64, spread: Spread, told: Note) -> Estimate {
    let shown = spread.bound(value, 0.025).is_some_and(|b| b > 0.0);
    if shown {
        return m.measured(channel, value, spread, METHOD).note(told);
    }
    // The upper end of the interval: whether there is a lower one was decided by the same means, and a limit of one side
    // would miss beside the misses of the intervals.
    let limit = spread.bound(value, 0.975).map(|value| UpperLimit { value, coverage: 0.95 });
    m.not_identifiable(channel, limit, METHOD).note(told).note(Note::new("runs.not_shown"))
}
