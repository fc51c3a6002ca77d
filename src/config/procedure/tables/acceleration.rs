//! The table of a procedure that asks for the sensitivity to acceleration.

use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::spec::Word;
use crate::config::table::{Table, words};
use crate::i18n::{Arg, Note, note};
use crate::measurand::Test;
use crate::rate_table::acceleration::{AccelerationTest, Order};
use crate::rate_table::setup::{Input, ReferenceInput};

/// Terms that are fitted.
const ORDERS: &[Word] = &[
    ("linear", "the bias and the accelerations along the three axes"),
    ("quadratic", "their squares and products too"),
];

words!(Order, ORDERS, |word: &str| match word {
    "linear" => Some(Order::Linear),
    "quadratic" => Some(Order::Quadratic),
    _ => None,
});

/// A test in positions in the field of gravity. The unit has the input axis I, the output axis O and S = I × O. The
/// Earth rate is taken out by [site]. `check` tells which terms the positions determine, and how well.
#[derive(Table)]
#[table("acceleration_test")]
pub(crate) struct AccelerationKeys {
    /// Terms of the model.
    #[key(optional, example = "quadratic")]
    order: Order,
    /// Standard uncertainty (k = 1) of the scale factor, from a scale-factor test: the Earth rate goes with the
    /// acceleration along the input axis.
    #[key(quantity = "ppm", min = 0, default = "500 ppm", example = "500 ppm")]
    scale_factor_uncertainty_ppm: f64,
    /// Standard uncertainty (k = 1) of every direction.
    #[key(quantity = "deg", min = 0, max = 90, default = "1 arcmin", example = "1 arcmin")]
    direction_uncertainty_deg: f64,
    /// Positions at rest, in the order of time.
    #[key(name = "position", required)]
    positions: Vec<GravityKeys>,
}

/// A position at rest.
#[derive(Table)]
#[table("acceleration_test.position")]
pub(crate) struct GravityKeys {
    /// Its phase in the manifest; instead of `from` and `to`.
    #[key(example = "face-up")]
    phase: Option<String>,
    /// Start, from the start of the recording.
    #[key(quantity = "s", min = 0, example = "0 s")]
    from_s: Option<f64>,
    /// End, from the start of the recording.
    #[key(quantity = "s", above = 0, example = "300 s")]
    to_s: Option<f64>,
    /// Heading of the input axis from true north, positive to the east.
    #[key(quantity = "deg", min = -360, max = 360, default = "90 deg", example = "90 deg")]
    heading_deg: f64,
    /// Elevation of the input axis above the horizon: 90 deg is up.
    #[key(quantity = "deg", min = -90, max = 90, example = "45 deg")]
    elevation_deg: f64,
    /// Angle about the input axis, by the right hand: 0 with the output axis horizontal and to the right of the input
    /// axis.
    #[key(quantity = "deg", min = -360, max = 360, default = "0 deg", example = "135 deg")]
    roll_deg: f64,
}

impl From<AccelerationKeys> for AccelerationTest {
    fn from(keys: AccelerationKeys) -> AccelerationTest {
        let tilt = keys.direction_uncertainty_deg;
        let rolls_deg = keys.positions.iter().map(|p| p.roll_deg).collect();
        let position = |p: GravityKeys| ReferenceInput {
            phase: p.phase,
            from_s: p.from_s,
            to_s: p.to_s,
            channel: None,
            input: Input::Position { heading: (p.heading_deg, tilt), elevation: (p.elevation_deg, tilt) },
        };
        AccelerationTest {
            order: keys.order,
            scale_factor_uncertainty: 1e-6 * keys.scale_factor_uncertainty_ppm,
            positions: keys.positions.into_iter().map(position).collect(),
            rolls_deg,
        }
    }
}

/// What a test of the acceleration and its measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        let at = section.span_of("id");
        match (&procedure.acceleration_test, measurand.test()) {
            (None, Test::Acceleration) => {
                let table = "acceleration_test";
                reader.error(&at, note!("check_temperature.needs_table", id = measurand.id, table), None);
            }
            (Some(_), test) if test.is_at_rest() => {
                reader.error(&at, note!("influence_check.static", id = measurand.id), None);
            }
            _ => {}
        }
    }
    let Some(section) = root.table("acceleration_test") else { return };
    if root.entry("site").is_none() {
        reader.error(&section.span.clone(), "acceleration.no_site", None);
    }
    for position in section.tables("position") {
        if let (Some(from), Some(to)) = (position.number("from"), position.number("to"))
            && to <= from
        {
            reader.error(&position.span_of("to"), "check.to_before_from", None);
        } else if position.text("phase").is_none()
            && position.entry("from").is_none()
            && position.entry("to").is_none()
        {
            reader.error(&position.span.clone(), "influence_check.no_place", None);
        }
    }
}

/// Angle random walk by which deviations are told where none is expected, deg/√h.
const UNIT_ANGLE_RANDOM_WALK: f64 = 1.0;

/// What the positions determine, for `sagnac check`: rank, missing terms, and the deviation of each term after an hour in each
/// position, for `angle_random_walk` in deg/√h or for one of 1.
pub(crate) fn determined(test: &AccelerationTest, angle_random_walk: Option<f64>) -> Vec<Note> {
    let design = test.design();
    let n = angle_random_walk.unwrap_or(UNIT_ANGLE_RANDOM_WALK);
    let terms = design.terms.iter().zip(&design.deviations);
    let deviations: Vec<Arg> = terms
        .filter_map(|(term, deviation)| {
            let deviation = Arg::figures(n * (*deviation)?, 2);
            Some(Arg::from(note!("acceleration.deviation", term = term.name(), deviation)))
        })
        .collect();
    let missing: Vec<Arg> = design.missing().map(|t| Arg::from(t.name())).collect();
    let mut notes = vec![note!(
        "acceleration.rank",
        positions = test.positions.len(),
        rank = design.rank,
        of = design.terms.len()
    )];
    if !missing.is_empty() {
        notes.push(note!("acceleration.missing", terms = Arg::Several(missing, ", ".into())));
    }
    if !deviations.is_empty() {
        let all = Arg::Several(deviations, ", ".into());
        notes.push(note!("acceleration.deviations", n = Arg::figures(n, 3), all));
    }
    notes
}
