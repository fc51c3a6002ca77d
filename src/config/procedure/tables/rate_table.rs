//! The table of a procedure that declares a test on a rate table.

use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::spec::Word;
use crate::config::table::Table;
use crate::i18n::note;
use crate::measurand::Test;
use crate::rate_table::setup::{Input, ReferenceInput, Setup};
use crate::recording::Role;

/// A test on a rate table: steps of constant rate are found in the channels with the roles `table_rate`,
/// `table_angle` and `outer_rate`, and the output is held against them. Uncertainties are standard
/// uncertainties (k = 1).
#[derive(Table)]
#[table("rate_table")]
pub(crate) struct RateTableKeys {
    /// True if every row of the recording is already the mean of a step.
    #[key(default = false, example = true)]
    rows_are_steps: bool,
    /// Time excluded after a change of rate.
    #[key(quantity = "s", min = 0, default = "2 s", example = "5 s")]
    settling_s: f64,
    /// Minimum time at one rate, without the settling; shorter stretches are not evaluated.
    #[key(quantity = "s", above = 0, default = "5 s", example = "20 s")]
    minimum_step_s: f64,
    /// Whether steps of at least one turn are cut to whole turns, over which wobble and the Earth's rotation
    /// average out.
    #[key(default = true, example = false)]
    whole_turns: bool,
    /// Full scale: the reference for ppm of full scale; the table must reach it. Default: the highest rate of the
    /// recording.
    #[key(quantity = "deg/h", above = 0, example = "100 deg/s")]
    full_scale_deg_h: Option<f64>,
    /// How far from full scale the highest rate may stay, and how far the angle of the table may disagree with its
    /// rate.
    #[key(quantity = "1", above = 0, max = 0.5, default = "1 %", example = "0.1 %")]
    rate_tolerance: f64,
    /// Largest deviation from the line of a rate that counts as followed, relative to the rate: what `maximum_rate` is
    /// the limit of. The line goes through the rates up to half of full scale.
    #[key(quantity = "1", above = 0, max = 0.5, default = "1 %", example = "0.5 %")]
    maximum_rate_error: f64,
    /// Lowest rate at which residuals are given in ppm of the rate. Default: a tenth of full scale.
    #[key(quantity = "deg/h", above = 0, example = "1 deg/s")]
    of_rate_from_deg_h: Option<f64>,
    /// Calibration of the table's rate or angle over whole turns, and of the clock.
    #[key(quantity = "ppm", min = 0, default = "0 ppm", example = "1 ppm")]
    rate_uncertainty_ppm: f64,
    /// Maximum deviation of the scale factor outside a dead zone from nominal, from a scale-factor test. If
    /// omitted, it is estimated from the small rates alone, and a dead zone as small as the noise of a step gets an
    /// upper limit only.
    #[key(quantity = "ppm", above = 0, example = "500 ppm")]
    scale_factor_uncertainty_ppm: Option<f64>,
    /// One reading of the table angle.
    #[key(quantity = "arcsec", min = 0, default = "0 arcsec", example = "2 arcsec")]
    angle_uncertainty_arcsec: f64,
    /// Angle between the input axis and the axis of the table.
    #[key(quantity = "mrad", min = 0, default = "0 mrad", example = "1 mrad")]
    alignment_uncertainty_mrad: f64,
    /// Channel of the unit's temperature. Default: the first.
    #[key(id, example = "temp")]
    temperature: Option<String>,
    /// The thermometer.
    #[key(difference = "degC", min = 0, default = "0 degC", example = "0.2 degC")]
    temperature_uncertainty_deg_c: f64,
    /// How far the temperature of a soak may be from the middle of its range, where the rates are repeated at several
    /// temperatures. Steps of which the temperature changes by more belong to no soak.
    #[key(difference = "degC", above = 0, default = "2 degC", example = "1 degC")]
    soak_tolerance_deg_c: f64,
    /// Shape of the output over rate.
    #[key(choice = RESPONSE_SHAPES, default = "line", example = "sine")]
    response: &'static str,
    /// Positions relative to the Earth's rotation, instead of a rotating table; needs [site].
    #[key(name = "position")]
    positions: Vec<PositionKeys>,
    /// Turns by a known angle, instead of a recorded table.
    #[key(name = "turn")]
    turns: Vec<TurnKeys>,
    /// Rests, which give the bias for the turns.
    #[key(name = "rest")]
    rests: Vec<RestKeys>,
}

const RESPONSE_SHAPES: &[Word] =
    &[("line", "a straight line: a closed loop"), ("sine", "a sine: an interferometer without a loop")];

/// A stretch of the recording.
#[derive(Table)]
struct StretchKeys {
    /// Its phase in the manifest; instead of `from` and `to`.
    #[key(example = "z_up")]
    phase: Option<String>,
    /// Start, from the start of the recording.
    #[key(quantity = "s", min = 0, example = "0 s")]
    from_s: Option<f64>,
    /// End, from the start of the recording.
    #[key(quantity = "s", above = 0, example = "300 s")]
    to_s: Option<f64>,
}

/// A position at rest against the Earth's rotation: where the input axis points.
#[derive(Table)]
#[table("rate_table.position")]
pub(crate) struct PositionKeys {
    #[key(flatten)]
    stretch: StretchKeys,
    /// Channel of the axis. Default: every gyro channel.
    #[key(id, example = "z")]
    channel: Option<String>,
    /// Heading from true north, positive to the east.
    #[key(quantity = "deg", min = -360, max = 360, default = "0 deg", example = "90 deg")]
    heading_deg: f64,
    /// Its uncertainty.
    #[key(quantity = "deg", min = 0, max = 360, default = "0 deg", example = "1 arcmin")]
    heading_uncertainty_deg: f64,
    /// Elevation above the horizon: 90 deg is up.
    #[key(quantity = "deg", min = -90, max = 90, example = "-90 deg")]
    elevation_deg: f64,
    /// Its uncertainty.
    #[key(quantity = "deg", min = 0, max = 90, default = "0 deg", example = "1 arcmin")]
    elevation_uncertainty_deg: f64,
}

/// A turn by a known angle, rests at both ends included.
#[derive(Table)]
#[table("rate_table.turn")]
pub(crate) struct TurnKeys {
    #[key(flatten)]
    stretch: StretchKeys,
    /// Channel about whose axis the unit is turned.
    #[key(id, example = "x")]
    channel: String,
    /// Angle turned by.
    #[key(quantity = "deg", example = "360 deg")]
    angle_deg: f64,
    /// Its uncertainty.
    #[key(quantity = "deg", min = 0, default = "0 deg", example = "0.5 deg")]
    angle_uncertainty_deg: f64,
}

/// A rest, which gives the bias for the turns.
#[derive(Table)]
#[table("rate_table.rest")]
pub(crate) struct RestKeys {
    #[key(flatten)]
    stretch: StretchKeys,
}

impl RateTableKeys {
    /// The setup that the table declares; `by_angle` where the recording has the angle of the table.
    pub(crate) fn setup(self, by_angle: bool) -> Setup {
        let positions = self.positions.into_iter().map(PositionKeys::input);
        let turns = self.turns.into_iter().map(TurnKeys::input);
        let rests = self.rests.into_iter().map(|rest| rest.stretch.input(None, Input::Rest));
        Setup {
            rows_are_steps: self.rows_are_steps,
            settling_s: self.settling_s,
            minimum_step_s: self.minimum_step_s,
            whole_turns: self.whole_turns,
            by_angle,
            full_scale_deg_h: self.full_scale_deg_h,
            of_rate_from_deg_h: self.of_rate_from_deg_h,
            maximum_rate_error: self.maximum_rate_error,
            rate_tolerance: self.rate_tolerance,
            rate_uncertainty: self.rate_uncertainty_ppm * 1e-6,
            scale_factor_uncertainty: self.scale_factor_uncertainty_ppm.map(|u| u * 1e-6),
            angle_uncertainty_arcsec: self.angle_uncertainty_arcsec,
            alignment_uncertainty_rad: self.alignment_uncertainty_mrad * 1e-3,
            temperature_uncertainty_deg_c: self.temperature_uncertainty_deg_c,
            soak_tolerance_deg_c: self.soak_tolerance_deg_c,
            temperature: self.temperature,
            sine: self.response == "sine",
            known: positions.chain(turns).chain(rests).collect(),
        }
    }
}

impl StretchKeys {
    fn input(self, channel: Option<String>, input: Input) -> ReferenceInput {
        ReferenceInput { phase: self.phase, from_s: self.from_s, to_s: self.to_s, channel, input }
    }
}

impl PositionKeys {
    fn input(self) -> ReferenceInput {
        let heading = (self.heading_deg, self.heading_uncertainty_deg);
        let elevation = (self.elevation_deg, self.elevation_uncertainty_deg);
        self.stretch.input(self.channel, Input::Position { heading, elevation })
    }
}

impl TurnKeys {
    fn input(self) -> ReferenceInput {
        let angle = (self.angle_deg, self.angle_uncertainty_deg);
        self.stretch.input(Some(self.channel), Input::Turn { angle })
    }
}

/// What a table test and its measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        let at = section.span_of("id");
        match (&procedure.rate_table, measurand.test()) {
            (None, Test::RateTable) => {
                let message = note!("rate_table_check.no_table", id = measurand.id);
                reader.error(&at, message, Some("rate_table_check.help.no_table".into()));
            }
            (Some(_), test) if test.is_at_rest() => {
                let message = note!("rate_table_check.static_measurand", id = measurand.id);
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
            let message = note!("rate_table_check.no_gyro", id);
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
            let message = note!("rate_table_check.no_temperature", id);
            reader.error(&section.span_of("temperature"), message, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_without_keys_is_the_usual_setup() {
        assert_eq!(RateTableKeys::default().setup(false), Setup::default());
    }
}
