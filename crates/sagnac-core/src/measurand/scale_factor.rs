//! Scale factor, its error and the bias of its line: from steps of a rate table, from turns by known angles and from
//! positions against the Earth rate.

use super::descriptor::{Measurand, OfKnownInput, Stimulus, TurnAxis};
use super::evidence::{KnownInputEvidence, TableEvidence};
use super::{cross_axis, sine_response};
use crate::estimate::{Component, Estimate, InputQuantity, Spread};
use crate::message::{Arg, Note, note};
use crate::rate_table::combine::spread;
use crate::rate_table::known::Positions;
use crate::rate_table::scale_factor::{METHOD, ScaleFactor};
use crate::rate_table::turns::Turned;

/// Output per input.
pub static SCALE_FACTOR: Measurand =
    Measurand::of_steps("scale_factor", "", "output per input", Stimulus::Rates, scale_factor)
        .or_known_input(OfKnownInput { positions: false, turns: Some(TurnAxis::Own), evaluate: of_turns })
        // Of samples that are rates or angles already, of counts an interval, of counts of rate.
        .recorded_in(&["1", "count/arcsec", "count/(deg/h)"])
        .also_called(&["sf", "scale", "sensitivity", "gain"])
        .signed();

/// Scale factor against the nominal one.
pub static SCALE_FACTOR_ERROR: Measurand = Measurand::of_steps(
    "scale_factor_error",
    "ppm",
    "deviation from the nominal scale factor",
    Stimulus::Rates,
    error,
)
.or_known_input(OfKnownInput { positions: true, turns: Some(TurnAxis::Own), evaluate: error_of_known_input })
.also_called(&["sfe", "sf_error"])
.signed();

/// Bias of the line.
pub static SCALE_FACTOR_BIAS: Measurand = Measurand::of_steps(
    "scale_factor_bias",
    "deg/h",
    "output at rest by the line through all rates",
    Stimulus::Rates,
    bias,
)
.or_known_input(OfKnownInput { positions: true, turns: None, evaluate: bias_of_positions })
.signed();

fn scale_factor(m: &Measurand, e: &TableEvidence<'_>) -> Vec<Estimate> {
    let (unit, factor) = e.as_recorded;
    let row = if e.setup.sine {
        sine_response::row(m, e, |s, slope| {
            let others = [e.setup.of_table_rate(slope.value * factor)];
            m.measured(&e.channel, slope.value * factor, spread(slope, factor.abs(), &others), s.method)
                .components(&others)
                .note(note!("on_table.at_zero"))
        })
    } else {
        let Some(line) = &e.line else { return vec![] };
        let others = of_equipment(line, e, (line.factor * factor).abs());
        let spread = spread(&line.slope(), factor.abs(), &others);
        m.measured(&e.channel, line.factor * factor, spread, METHOD).components(&others).note(cited(line, e))
    };
    vec![Estimate { unit, ..row }]
}

fn error(m: &Measurand, e: &TableEvidence<'_>) -> Vec<Estimate> {
    if e.setup.sine {
        return vec![sine_response::row(m, e, |s, slope| {
            let of_table = [e.setup.of_table_rate(1e6)];
            let spread = spread(slope, 1e6, &of_table);
            m.measured(&e.channel, (slope.value - 1.0) * 1e6, spread, s.method)
                .components(&of_table)
                .note(note!("on_table.at_zero"))
        })];
    }
    let Some(line) = &e.line else { return vec![] };
    let others = of_equipment(line, e, 1e6 * line.factor.abs());
    let spread = spread(&line.slope(), 1e6, &others);
    vec![m.measured(&e.channel, (line.factor - 1.0) * 1e6, spread, METHOD).components(&others)]
}

/// The bias of the line without the Earth rate along the axis, where the site tells it.
fn bias(m: &Measurand, e: &TableEvidence<'_>) -> Vec<Estimate> {
    let Some(line) = &e.line else { return vec![] };
    let Some(earth) = e.earth else {
        return vec![m.measured(&e.channel, line.bias, spread(&line.offset(), 1.0, &[]), METHOD)];
    };
    let found = line.output_without(earth.rate_deg_h);
    let others = [
        Component::of(InputQuantity::EarthRate, earth.uncertainty_deg_h, "deg/h", line.factor),
        e.setup.of_table_rate(earth.rate_deg_h),
    ];
    vec![
        m.measured(&e.channel, found.value, spread(&found, 1.0, &others), METHOD)
            .components(&others)
            .note(note!("on_table.earth_removed", earth = Arg::figures(earth.rate_deg_h, 5))),
    ]
}

/// Components of the scale factor from calibration of the table, its cosine with the input axis, and the thermometer, for a scale
/// factor of `size` in the unit of the row.
fn of_equipment(line: &ScaleFactor, e: &TableEvidence<'_>, size: f64) -> [Component; 3] {
    let angle = e.setup.alignment_uncertainty_rad;
    [
        e.setup.of_table_rate(size),
        Component::of(InputQuantity::AxisAlignment, angle, "rad", angle * size),
        e.setup.of_thermometer(1e-6 * line.temperature_slope() * size),
    ]
}

/// What stands behind the scale factor: levels, steps, cycles, whether from the angle.
fn cited(line: &ScaleFactor, e: &TableEvidence<'_>) -> Note {
    let key = if e.setup.by_angle { "on_table.from_angle" } else { "on_table.from_rate" };
    Note::new(key)
        .with("steps", e.steps.list.len())
        .with("levels", line.response.levels.len())
        .with("cycles", e.steps.cycles)
}

fn of_turns(m: &Measurand, known: &KnownInputEvidence<'_>) -> Vec<Estimate> {
    let row = |t: &Turned| {
        let row = cross_axis::of_turn(m, t, &t.output, t.factor.value, 1.0);
        Estimate { unit: "1", ..row }
    };
    own_turns(known).map(row).collect()
}

fn error_of_known_input(m: &Measurand, known: &KnownInputEvidence<'_>) -> Vec<Estimate> {
    let positions = known
        .positions
        .iter()
        .map(|p| of_positions(m, p, 1e6 * (p.factor.value - 1.0), spread(&p.factor, 1e6, &[])));
    let turns =
        own_turns(known).map(|t| cross_axis::of_turn(m, t, &t.output, 1e6 * (t.factor.value - 1.0), 1e6));
    positions.chain(turns).collect()
}

fn bias_of_positions(m: &Measurand, known: &KnownInputEvidence<'_>) -> Vec<Estimate> {
    known.positions.iter().map(|p| of_positions(m, p, p.bias.value, spread(&p.bias, 1.0, &[]))).collect()
}

/// Turns of each channel about its own axis.
fn own_turns<'a>(known: &KnownInputEvidence<'a>) -> impl Iterator<Item = &'a Turned> {
    known.turns.into_iter().flat_map(|t| &t.table).filter(|t| t.output == t.axis)
}

fn of_positions(m: &Measurand, p: &Positions, value: f64, spread: Spread) -> Estimate {
    const METHOD: &str = "earth_rate_positions";
    // Outputs whose bias was turned with them tell neither scale factor nor bias.
    if p.turned_instead.is_some() || !p.turned_in_software().is_empty() {
        return m.not_identifiable(&p.channel, None, METHOD).note(note!("known.refused"));
    }
    m.measured(&p.channel, value, spread, METHOD).note(note!("known.positions", n = p.means.len()))
}

#[cfg(test)]
mod tests {
    use super::super::evidence::Earth;
    use super::super::test_evidence::{
        combination, diagonal, line, near, notes, number, on_table, shows, student, told, withholds,
    };
    use super::*;
    use crate::rate_table::Setup;
    use crate::rate_table::design::Extra;
    use crate::rate_table::known::Mean;
    use crate::rate_table::sine::Sine;
    use crate::rate_table::steps::Steps;
    use crate::rate_table::turns::Turns;

    /// Levels of −200 to 200 deg/h, Σx² = 1e5: means with a variance of 4e-7 give the slope that of 4e-12 and the offset
    /// that of 8e-8. The scale factor changes by 8 ppm/degC.
    fn found() -> (Steps, ScaleFactor) {
        let rates = [-200.0, -100.0, 0.0, 100.0, 200.0];
        let means = [0.0, 0.0, 0.0, 0.0, 0.0, -8.0];
        let covariance = diagonal(&[4e-7, 4e-7, 4e-7, 4e-7, 4e-7, 0.01]);
        let (steps, mut line) = line(&rates, &means, &[Extra::ScaleOverTemperature], covariance);
        (line.factor, line.bias, line.full_scale) = (1.002, 3.0, 200.0);
        (steps, line)
    }

    /// 3 ppm of the table, 4 ppm of its cosine, half a degree of the thermometer.
    fn setup() -> Setup {
        Setup {
            rate_uncertainty: 3e-6,
            alignment_uncertainty_rad: 2e-3,
            temperature_uncertainty_deg_c: 0.5,
            ..Setup::default()
        }
    }

    #[test]
    fn a_scale_factor_is_in_recorded_units_with_what_is_known_of_the_table() {
        let (steps, line) = found();
        for (by_angle, key) in [(false, "on_table.from_rate"), (true, "on_table.from_angle")] {
            let setup = Setup { by_angle, ..setup() };
            let e = TableEvidence {
                as_recorded: ("V/(deg/h)", -2.5),
                ..on_table(&setup, &steps, Some(line.clone()))
            };
            let row = &SCALE_FACTOR.evaluate_steps(&e)[0];
            shows(row, -2.505, METHOD);
            assert_eq!((row.unit, notes(row)), ("V/(deg/h)", vec![key]));
            // Slope 2e-6·2.5; 3, 4 and 8·0.5 ppm of 2.505.
            let ppm = 2.505e-6f64;
            near(student(row).0, (25e-12 + 41.0 * ppm * ppm).sqrt());
            assert_eq!(["steps", "levels", "cycles"].map(|n| number(row, key, n)), [5.0, 5.0, 1.0]);
        }
        let setup = setup();
        let row = &SCALE_FACTOR_ERROR.evaluate_steps(&on_table(&setup, &steps, Some(line)))[0];
        shows(row, 2000.0, METHOD);
        near(student(row).0, (4.0 + 41.0 * 1.002f64 * 1.002).sqrt());
        for m in [&SCALE_FACTOR, &SCALE_FACTOR_ERROR, &SCALE_FACTOR_BIAS] {
            assert!(m.evaluate_steps(&on_table(&setup, &steps, None)).is_empty());
        }
    }

    #[test]
    fn the_bias_is_that_of_the_line_less_the_earth_rate() {
        let ((steps, line), setup) = (found(), setup());
        let mut e = on_table(&setup, &steps, Some(line));
        let row = &SCALE_FACTOR_BIAS.evaluate_steps(&e)[0];
        shows(row, 3.0, METHOD);
        near(student(row).0, 8e-8f64.sqrt());
        e.earth = Some(Earth { rate_deg_h: 10.0, uncertainty_deg_h: 3e-4 });
        let row = &SCALE_FACTOR_BIAS.evaluate_steps(&e)[0];
        shows(row, 3.0 - 10.02, METHOD);
        // Offset less ten slopes: 8e-8 + 100·4e-12; 1.002·3e-4 of the site and 3e-6·10 of the table.
        near(student(row).0, (8e-8 + 4e-10 + (1.002f64 * 3e-4).powi(2) + 9e-10).sqrt());
        near(number(row, "on_table.earth_removed", "earth"), 10.0);
    }

    #[test]
    fn a_sine_gives_the_scale_factor_at_zero_rate() {
        let ((steps, _), setup) = (found(), Setup { sine: true, ..setup() });
        let sine = Sine {
            fit: super::super::test_evidence::fitted(&[0.0, 0.98], diagonal(&[0.0, 4e-12])),
            kappa: 2e-5,
            kappa_standard: 1e-8,
            slope: 0.98,
            mean_slope: 0.98,
            rms: 1.0,
            rms_of_line: 2.0,
            dof: 9.0,
            temperature_range: 0.0,
            rows: vec![],
        };
        let mut e = TableEvidence { sine: Some(sine), ..on_table(&setup, &steps, None) };
        e.as_recorded = ("V/(deg/h)", -2.5);
        let row = &SCALE_FACTOR.evaluate_steps(&e)[0];
        shows(row, -2.45, "sine_response");
        assert_eq!((row.unit, notes(row)), ("V/(deg/h)", vec!["on_table.at_zero"]));
        near(student(row).0, 5e-6f64.hypot(3e-6 * 2.45));
        let row = &SCALE_FACTOR_ERROR.evaluate_steps(&e)[0];
        shows(row, -2e4, "sine_response");
        near(student(row).0, 13f64.sqrt());
        assert_eq!(notes(row), ["on_table.at_zero"]);
        assert!(SCALE_FACTOR_BIAS.evaluate_steps(&e).is_empty());
    }

    fn positions() -> Positions {
        let mean =
            |output, earth| Mean { name: String::new(), output, standard: 0.01, earth, earth_standard: 0.01 };
        Positions {
            channel: "g".into(),
            factor: combination(0.9995, 1e-4),
            bias: combination(1.5, 0.02),
            means: vec![mean(11.5, 10.0), mean(-8.5, -10.0)],
            turned_instead: None,
        }
    }

    fn turned(output: &str, axis: &str) -> Turned {
        let factor = combination(1.0003, 2e-6);
        Turned { output: output.into(), axis: axis.into(), factor, by_angle: 3e-6, by_earth: 0.0 }
    }

    #[test]
    fn positions_and_turns_tell_error_and_bias() {
        let (list, turns) = ([positions()], Turns { table: vec![turned("g", "g"), turned("g", "h")] });
        let known = KnownInputEvidence { positions: &list, turns: Some(&turns) };
        let factors = SCALE_FACTOR.evaluate_known_input(&known);
        assert_eq!(factors.len(), 1);
        shows(&factors[0], 1.0003, "known_angles");
        assert_eq!(factors[0].unit, "1");
        near(student(&factors[0]).0, 13f64.sqrt() * 1e-6);
        assert_eq!(told(&factors[0], "known.turns", "axis"), &Arg::Text("g".into()));
        let errors = SCALE_FACTOR_ERROR.evaluate_known_input(&known);
        assert_eq!(errors.len(), 2);
        shows(&errors[0], 1e6 * (0.9995 - 1.0), "earth_rate_positions");
        near(student(&errors[0]).0, 100.0);
        assert_eq!(number(&errors[0], "known.positions", "n"), 2.0);
        shows(&errors[1], 1e6 * (1.0003 - 1.0), "known_angles");
        near(student(&errors[1]).0, 13f64.sqrt());
        let biases = SCALE_FACTOR_BIAS.evaluate_known_input(&known);
        assert_eq!(biases.len(), 1);
        shows(&biases[0], 1.5, "earth_rate_positions");
        near(student(&biases[0]).0, 0.02);
    }

    #[test]
    fn positions_whose_outputs_were_turned_tell_nothing() {
        let instead = Positions { turned_instead: Some(("h".into(), 1.0)), ..positions() };
        // Outputs opposite to one another that are not those of the Earth: the bias was turned with them.
        let mut in_software = positions();
        (in_software.means[0].output, in_software.means[1].output) = (5.0, -5.0);
        for list in [[instead], [in_software]] {
            let row = &SCALE_FACTOR_BIAS
                .evaluate_known_input(&KnownInputEvidence { positions: &list, turns: None })[0];
            withholds(row, None, "earth_rate_positions");
            assert_eq!(notes(row), ["known.refused"]);
        }
    }
}
