//! Scale factor, its error and the bias of its line: from steps of a rate table, from turns by known angles and from
//! positions against the Earth rate.

use super::descriptor::{Measurand, OfKnownInput, Stimulus, TurnAxis};
use super::evidence::{KnownInputEvidence, TableEvidence};
use super::{cross_axis, sine_response};
use crate::estimate::{Estimate, Spread};
use crate::message::{Arg, Note};
use crate::rate_table::combine::spread;
use crate::rate_table::known::Positions;
use crate::rate_table::scale_factor::{METHOD, ScaleFactor};
use crate::rate_table::turns::Turned;

/// Output per input.
pub static SCALE_FACTOR: Measurand =
    Measurand::of_steps("scale_factor", "", "output per input", Stimulus::Rates, scale_factor)
        .or_known_input(OfKnownInput { positions: false, turns: Some(TurnAxis::Own), evaluate: of_turns })
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
            let others = [e.setup.rate_uncertainty * (slope.value * factor).abs()];
            m.measured(&e.channel, slope.value * factor, spread(slope, factor.abs(), &others), s.method)
                .note(Note::new("on_table.at_zero"))
        })
    } else {
        let Some(line) = &e.line else { return vec![] };
        let others = systematic(line, e).map(|u| u * 1e-6 * (line.factor * factor).abs());
        let spread = spread(&line.slope(), factor.abs(), &others);
        m.measured(&e.channel, line.factor * factor, spread, METHOD).note(cited(line, e))
    };
    vec![Estimate { unit, ..row }]
}

fn error(m: &Measurand, e: &TableEvidence<'_>) -> Vec<Estimate> {
    if e.setup.sine {
        return vec![sine_response::row(m, e, |s, slope| {
            let spread = spread(slope, 1e6, &[1e6 * e.setup.rate_uncertainty]);
            m.measured(&e.channel, (slope.value - 1.0) * 1e6, spread, s.method)
                .note(Note::new("on_table.at_zero"))
        })];
    }
    let Some(line) = &e.line else { return vec![] };
    let spread = spread(&line.slope(), 1e6, &systematic(line, e).map(|u| u * line.factor.abs()));
    vec![m.measured(&e.channel, (line.factor - 1.0) * 1e6, spread, METHOD)]
}

/// The bias of the line without the Earth rate along the axis, where the site tells it.
fn bias(m: &Measurand, e: &TableEvidence<'_>) -> Vec<Estimate> {
    let Some(line) = &e.line else { return vec![] };
    let Some(earth) = e.earth else {
        return vec![m.measured(&e.channel, line.bias, spread(&line.offset(), 1.0, &[]), METHOD)];
    };
    let found = line.output_without(earth.rate_deg_h);
    let others = [line.factor * earth.uncertainty_deg_h, e.setup.rate_uncertainty * earth.rate_deg_h];
    vec![
        m.measured(&e.channel, found.value, spread(&found, 1.0, &others), METHOD)
            .note(Note::new("on_table.earth_removed").with("earth", Arg::figures(earth.rate_deg_h, 5))),
    ]
}

/// Relative uncertainties of the scale factor from calibration of the table, its cosine with the input axis, and the
/// thermometer, ppm.
fn systematic(line: &ScaleFactor, e: &TableEvidence<'_>) -> [f64; 3] {
    let alignment = e.setup.alignment_uncertainty_rad * e.setup.alignment_uncertainty_rad;
    [
        1e6 * e.setup.rate_uncertainty,
        1e6 * alignment,
        line.temperature_slope() * e.setup.temperature_uncertainty_deg_c,
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
        return m.not_identifiable(&p.channel, None, METHOD).note(Note::new("known.refused"));
    }
    m.measured(&p.channel, value, spread, METHOD).note(Note::new("known.positions").with("n", p.means.len()))
}
