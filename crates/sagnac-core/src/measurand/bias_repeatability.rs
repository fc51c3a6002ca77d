//! Repeatability of the bias from switching on to switching on.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::influence::repeatability::{Repeatability, factors};
use crate::message::{Arg, Note, note};
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
    let told = note!(
        "runs.repeatability",
        n,
        low = Arg::figures(low, 2),
        high = Arg::figures(high, 3),
        plain = Arg::figures(runs.plain, 3),
        noise = Arg::figures(typical, 2)
    );
    shown_or_bounded(m, &runs.channel, value, spread, told)
}

fn peak_to_peak(m: &Measurand, runs: &Repeatability) -> Estimate {
    let told = note!("runs.range", n = runs.runs.len(), plain = Arg::figures(runs.range.plain, 3));
    shown_or_bounded(m, &runs.channel, runs.range.value, runs.range.spread.clone(), told)
}

fn trend(m: &Measurand, runs: &Repeatability) -> Estimate {
    let n = runs.runs.len();
    match &runs.trend {
        Some(t) => in_step(runs, measured(m, runs, t).note(note!("runs.trend", n))),
        None if n >= 4 => in_step(runs, none(m, runs, "runs.not_apart")),
        None => none(m, runs, "runs.no_line"),
    }
}

fn temperature(m: &Measurand, runs: &Repeatability) -> Estimate {
    match &runs.temperature {
        Some(t) => {
            let note = note!(
                "runs.temperature",
                percent = Arg::figures(100.0 * t.share, 2),
                left = Arg::figures(t.left, 3),
                range = Arg::figures(t.range, 2)
            );
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
        None => row.note(note!("runs.trend_alone")),
        Some(r) if r.abs() >= IN_STEP => row.note(note!("runs.in_step", correlation = Arg::figures(r, 2))),
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
    m.not_identifiable(channel, limit, METHOD).note(told).note(note!("runs.not_shown"))
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{combination, near, notes, number, shows, student, withholds};
    use super::*;
    use crate::influence::range::Range;
    use crate::influence::repeatability::{OverTemperature, RunMean};

    fn runs(count: usize) -> Repeatability {
        let run = |i: usize| RunMean {
            name: String::new(),
            span_s: (0.0, 1.0),
            row: 1,
            bias: combination(i as f64, if i == 0 { 0.5 } else { 0.1 }),
            temperature: f64::NAN,
        };
        let spread = Spread::Normal { standard_uncertainty: 0.1 };
        Repeatability {
            channel: "g".into(),
            runs: (0..count).map(run).collect(),
            mean: 0.0,
            deviation: (0.4, spread.clone()),
            plain: 0.45,
            range: Range { value: 1.5, plain: 1.7, spread },
            trend: None,
            in_step: None,
            copied: None,
            temperature: None,
        }
    }

    fn row(m: &Measurand, runs: &Repeatability) -> Estimate {
        let mut rows = m.evaluate_runs(runs);
        assert_eq!(rows.len(), 1);
        rows.remove(0)
    }

    #[test]
    fn a_deviation_and_a_range_that_are_clear_of_zero_are_stated() {
        let found = row(&BIAS_REPEATABILITY, &runs(5));
        shows(&found, 0.4, "means_of_runs");
        assert_eq!(notes(&found), ["runs.repeatability"]);
        // (0.25 + 4·0.01)/5 = 0.058. χ² of 4 degrees lies within 0.48442 and 11.1433 (tables).
        near(number(&found, "runs.repeatability", "noise"), 0.058f64.sqrt());
        near(number(&found, "runs.repeatability", "plain"), 0.45);
        near(number(&found, "runs.repeatability", "n"), 5.0);
        assert!((number(&found, "runs.repeatability", "low") - (4.0f64 / 11.143_287).sqrt()).abs() < 1e-6);
        assert!((number(&found, "runs.repeatability", "high") - (4.0f64 / 0.484_419).sqrt()).abs() < 1e-5);
        let found = row(&BIAS_REPEATABILITY_PEAK_TO_PEAK, &runs(5));
        shows(&found, 1.5, "means_of_runs");
        near(number(&found, "runs.range", "plain"), 1.7);
    }

    #[test]
    fn an_interval_that_reaches_zero_gives_its_upper_end() {
        let mut runs = runs(5);
        // 0.19 − 1.96·0.1 < 0.
        runs.deviation.0 = 0.19;
        let found = row(&BIAS_REPEATABILITY, &runs);
        withholds(&found, Some(0.19 + 1.959_963_984_540_054 * 0.1), "means_of_runs");
        assert_eq!(notes(&found), ["runs.repeatability", "runs.not_shown"]);
        runs.deviation = (0.3, Spread::Curve(vec![(-4.0, 0.0), (0.0, 0.0), (1.0, 0.5), (4.0, 0.5)]));
        withholds(&row(&BIAS_REPEATABILITY, &runs), Some(0.5), "means_of_runs");
        runs.deviation.1 = Spread::Unknown;
        withholds(&row(&BIAS_REPEATABILITY, &runs), None, "means_of_runs");
    }

    #[test]
    fn a_trend_says_whether_the_temperature_went_with_it() {
        let mut runs = runs(4);
        let m = &BIAS_REPEATABILITY_TREND;
        assert_eq!(notes(&row(m, &runs)), ["runs.not_apart", "runs.trend_alone"]);
        runs.trend = Some(Combination { value: -0.7, standard: 0.2, dof: 6.0 });
        for (in_step, remark) in
            [(None, Some("runs.trend_alone")), (Some(-0.7), Some("runs.in_step")), (Some(0.69), None)]
        {
            runs.in_step = in_step;
            let found = row(m, &runs);
            shows(&found, -0.7, "means_of_runs");
            assert_eq!(student(&found), (0.2, 6.0));
            assert_eq!(notes(&found)[1..], remark.into_iter().collect::<Vec<_>>()[..]);
        }
        let none = row(m, &self::runs(3));
        withholds(&none, None, "means_of_runs");
        assert_eq!(notes(&none), ["runs.no_line"]);
    }

    #[test]
    fn what_goes_with_temperature_has_its_share_or_its_reason() {
        let mut of_four = runs(4);
        let m = &BIAS_REPEATABILITY_TEMPERATURE;
        let slope = Combination { value: 0.03, standard: 0.01, dof: 3.0 };
        of_four.temperature = Some(OverTemperature { slope, left: 0.2, share: 0.64, range: 12.0 });
        let found = row(m, &of_four);
        shows(&found, 0.03, "means_of_runs");
        assert_eq!(student(&found), (0.01, 3.0));
        for (name, value) in [("percent", 64.0), ("left", 0.2), ("range", 12.0)] {
            near(number(&found, "runs.temperature", name), value);
        }
        of_four.temperature = None;
        assert_eq!(notes(&row(m, &of_four)), ["runs.no_temperature"]);
        of_four.in_step = Some(1.0);
        assert_eq!(notes(&row(m, &of_four)), ["runs.not_apart", "runs.in_step"]);
        assert_eq!(notes(&row(m, &runs(3))), ["runs.no_line"]);
        assert_eq!(notes(&row(m, &runs(5))), ["runs.no_temperature"]);
    }
}
