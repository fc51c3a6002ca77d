//! The table of a procedure that declares a test on a rate table.

use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::spec::{
    Kind, Range, TableSpec, Word, difference, optional, quantity, required, with_default,
};
use crate::i18n::Note;
use crate::measurand::Test;
use crate::rate_table::setup::{Input, ReferenceInput, Setup};
use crate::recording::Role;

pub(crate) static RATE_TABLE: TableSpec = TableSpec {
    name: "rate_table",
    doc: "A test on a rate table: steps of constant rate are found in the channels with the roles `table_rate`, \
          `table_angle` and `outer_rate`, and the output is held against them. Uncertainties are standard uncertainties \
          (k = 1).",
    keys: &[
        with_default(
            "rows_are_steps",
            Kind::Flag,
            "false",
            "true",
            "True if every row of the recording is already the mean of a step.",
        ),
        with_default(
            "settling",
            quantity("s", Range::NOT_NEGATIVE),
            "\"2 s\"",
            "\"5 s\"",
            "Time excluded after a change of rate.",
        ),
        with_default(
            "minimum_step",
            quantity("s", Range::POSITIVE),
            "\"5 s\"",
            "\"20 s\"",
            "Minimum time at one rate, without the settling; shorter stretches are not evaluated.",
        ),
        with_default(
            "whole_turns",
            Kind::Flag,
            "true",
            "false",
            "Whether steps of at least one turn are cut to whole turns, over which wobble and the Earth's \
             rotation average out.",
        ),
        optional(
            "full_scale",
            quantity("deg/h", Range::POSITIVE),
            "\"100 deg/s\"",
            "Full scale: the reference for ppm of full scale; the table must reach it. Default: the highest \
             rate of the recording.",
        ),
        with_default(
            "rate_tolerance",
            quantity("1", Range::above_up_to(0.0, 0.5)),
            "\"1 %\"",
            "\"0.1 %\"",
            "How far from full scale the highest rate may stay, and how far the angle of the table may disagree with its rate.",
        ),
        optional(
            "of_rate_from",
            quantity("deg/h", Range::POSITIVE),
            "\"1 deg/s\"",
            "Lowest rate at which residuals are given in ppm of the rate. Default: a tenth of full scale.",
        ),
        with_default(
            "rate_uncertainty",
            quantity("ppm", Range::NOT_NEGATIVE),
            "\"0 ppm\"",
            "\"1 ppm\"",
            "Calibration of the table's rate or angle over whole turns, and of the clock.",
        ),
        optional(
            "scale_factor_uncertainty",
            quantity("ppm", Range::POSITIVE),
            "\"500 ppm\"",
            "Maximum deviation of the scale factor outside a dead zone from nominal, from a scale-factor \
             test. If omitted, it is estimated from the small rates alone, and a dead zone as small as the \
             noise of a step gets an upper limit only.",
        ),
        with_default(
            "angle_uncertainty",
            quantity("arcsec", Range::NOT_NEGATIVE),
            "\"0 arcsec\"",
            "\"2 arcsec\"",
            "One reading of the table angle.",
        ),
        with_default(
            "alignment_uncertainty",
            quantity("mrad", Range::NOT_NEGATIVE),
            "\"0 mrad\"",
            "\"1 mrad\"",
            "Angle between the input axis and the axis of the table.",
        ),
        optional(
            "temperature",
            Kind::Id,
            "\"temp\"",
            "Channel of the unit's temperature. Default: the first.",
        ),
        with_default(
            "temperature_uncertainty",
            difference("degC", Range::NOT_NEGATIVE),
            "\"0 degC\"",
            "\"0.2 degC\"",
            "The thermometer.",
        ),
        with_default(
            "response",
            Kind::Choice(RESPONSES),
            "\"line\"",
            "\"sine\"",
            "Shape of the output over rate.",
        ),
        optional(
            "position",
            Kind::Tables(&POSITION),
            "",
            "Positions relative to the Earth's rotation, instead of a rotating table; needs [site].",
        ),
        optional("turn", Kind::Tables(&TURN), "", "Turns by a known angle, instead of a recorded table."),
        optional("rest", Kind::Tables(&REST), "", "Rests, which give the bias for the turns."),
    ],
};

const RESPONSES: &[Word] =
    &[("line", "a straight line: a closed loop"), ("sine", "a sine: an interferometer without a loop")];

const PHASE: crate::config::spec::KeySpec =
    optional("phase", Kind::Text, "\"z_up\"", "Its phase in the manifest; instead of `from` and `to`.");
const FROM: crate::config::spec::KeySpec = optional(
    "from",
    quantity("s", Range::NOT_NEGATIVE),
    "\"0 s\"",
    "Start, from the start of the recording.",
);
const TO: crate::config::spec::KeySpec =
    optional("to", quantity("s", Range::POSITIVE), "\"300 s\"", "End, from the start of the recording.");
const ANGLE: Range = Range::between(-360.0, 360.0);

static POSITION: TableSpec = TableSpec {
    name: "rate_table.position",
    doc: "A position at rest against the Earth's rotation: where the input axis points.",
    keys: &[
        PHASE,
        FROM,
        TO,
        optional("channel", Kind::Id, "\"z\"", "Channel of the axis. Default: every gyro channel."),
        with_default(
            "heading",
            quantity("deg", ANGLE),
            "\"0 deg\"",
            "\"90 deg\"",
            "Heading from true north, positive to the east.",
        ),
        with_default(
            "heading_uncertainty",
            quantity("deg", Range::between(0.0, 360.0)),
            "\"0 deg\"",
            "\"1 arcmin\"",
            "Its uncertainty.",
        ),
        required(
            "elevation",
            quantity("deg", Range::between(-90.0, 90.0)),
            "\"-90 deg\"",
            "Elevation above the horizon: 90 deg is up.",
        ),
        with_default(
            "elevation_uncertainty",
            quantity("deg", Range::between(0.0, 90.0)),
            "\"0 deg\"",
            "\"1 arcmin\"",
            "Its uncertainty.",
        ),
    ],
};

static TURN: TableSpec = TableSpec {
    name: "rate_table.turn",
    doc: "A turn by a known angle, rests at both ends included.",
    keys: &[
        PHASE,
        FROM,
        TO,
        required("channel", Kind::Id, "\"x\"", "Channel about whose axis the unit is turned."),
        required("angle", quantity("deg", Range::ANY), "\"360 deg\"", "Angle turned by."),
        with_default(
            "angle_uncertainty",
            quantity("deg", Range::NOT_NEGATIVE),
            "\"0 deg\"",
            "\"0.5 deg\"",
            "Its uncertainty.",
        ),
    ],
};

static REST: TableSpec = TableSpec {
    name: "rate_table.rest",
    doc: "A rest, which gives the bias for the turns.",
    keys: &[PHASE, FROM, TO],
};

/// The setup that the table declares.
pub(crate) fn setup(section: &Section, root: &Section) -> Setup {
    let number = |key: &str| section.number(key);
    let usual = Setup::default();
    Setup {
        rows_are_steps: section.flag("rows_are_steps"),
        settling_s: number("settling").unwrap_or(usual.settling_s),
        minimum_step_s: number("minimum_step").unwrap_or(usual.minimum_step_s),
        whole_turns: section.flag("whole_turns"),
        by_angle: root.tables("channel").iter().any(|c| c.word("role") == Some("table_angle")),
        full_scale_deg_h: number("full_scale"),
        of_rate_from_deg_h: number("of_rate_from"),
        rate_tolerance: number("rate_tolerance").unwrap_or(usual.rate_tolerance),
        rate_uncertainty: number("rate_uncertainty").unwrap_or(0.0) * 1e-6,
        scale_factor_uncertainty: number("scale_factor_uncertainty").map(|u| u * 1e-6),
        angle_uncertainty_arcsec: number("angle_uncertainty").unwrap_or(0.0),
        alignment_uncertainty_rad: number("alignment_uncertainty").unwrap_or(0.0) * 1e-3,
        temperature_uncertainty_deg_c: number("temperature_uncertainty").unwrap_or(0.0),
        temperature: section.text("temperature"),
        sine: section.word("response") == Some("sine"),
        known: known(section),
    }
}

fn known(section: &Section) -> Vec<ReferenceInput> {
    let one = |s: &Section, input: Input| ReferenceInput {
        phase: s.text("phase"),
        from_s: s.number("from"),
        to_s: s.number("to"),
        channel: s.text("channel"),
        input,
    };
    let pair = |s: &Section, key: &str, uncertainty: &str| {
        (s.number(key).unwrap_or(0.0), s.number(uncertainty).unwrap_or(0.0))
    };
    let positions = section.tables("position").iter().map(|s| {
        let heading = pair(s, "heading", "heading_uncertainty");
        let elevation = pair(s, "elevation", "elevation_uncertainty");
        one(s, Input::Position { heading, elevation })
    });
    let turns = section
        .tables("turn")
        .iter()
        .map(|s| one(s, Input::Turn { angle: pair(s, "angle", "angle_uncertainty") }));
    let rests = section.tables("rest").iter().map(|s| one(s, Input::Rest));
    positions.chain(turns).chain(rests).collect()
}

/// What a table test and its measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        let at = section.span_of("id");
        match (&procedure.rate_table, measurand.test()) {
            (None, Test::RateTable) => {
                let message = Note::new("rate_table_check.no_table").with("id", measurand.id);
                reader.error(&at, message, Some("rate_table_check.help.no_table".into()));
            }
            (Some(_), Test::Static) => {
                let message = Note::new("rate_table_check.static_measurand").with("id", measurand.id);
                reader.error(&at, message, Some("rate_table_check.help.static_measurand".into()));
            }
            _ => {}
        }
    }
    let Some(section) = root.table("rate_table") else { return };
    let known = |role: Role| procedure.channels.iter().any(|c| c.channel.role == role);
    let moves = [Role::TableRate, Role::TableAngle, Role::OuterRate].into_iter().any(known);
    let stated = section.entry("position").is_some() || section.entry("turn").is_some();
    if section.entry("position").is_some() && root.entry("site").is_none() {
        let help = Some("rate_table_check.help.no_site".into());
        reader.error(&section.span_of("position"), "rate_table_check.no_site", help);
    }
    for part in ["position", "turn"].iter().flat_map(|name| section.tables(name)) {
        let Some(id) = part.text("channel") else { continue };
        if !procedure.channel(&id).is_some_and(|c| c.channel.role.is_gyro()) {
            let message = Note::new("rate_table_check.no_gyro").with("id", id);
            reader.error(&part.span_of("channel"), message, None);
        }
    }
    if !moves && !stated && !procedure.channels.is_empty() {
        let help = Some("rate_table_check.help.no_channel".into());
        reader.error(&section.span.clone(), "rate_table_check.no_channel", help);
    }
    if let Some(id) = section.text("temperature") {
        let suits = procedure.channel(&id).is_some_and(|c| c.channel.role == Role::Temperature);
        if !suits {
            let message = Note::new("rate_table_check.no_temperature").with("id", id);
            reader.error(&section.span_of("temperature"), message, None);
        }
    }
}
