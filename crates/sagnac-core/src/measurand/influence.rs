//! What an influence changes bias and scale factor by: per unit of the influence, and at every level.

use super::descriptor::Measurand;
use super::evidence::ComparisonEvidence;
use crate::estimate::{Component, Estimate, InputQuantity};
use crate::influence::comparison::{Comparison, Effect, Term};
use crate::influence::setup::{
    BIAS_PER_LEVEL, BIAS_PER_SQUARE, Influence, LevelUnit, SCALE_FACTOR_PER_LEVEL, SCALE_FACTOR_PER_SQUARE,
};
use crate::message::{Arg, Note, note};
use crate::numeric::reml::Combination;
use crate::rate_table::combine::spread;

/// Bias per magnetic field.
pub static MAGNETIC_SENSITIVITY: Measurand = Measurand::of_influence(
    "magnetic_sensitivity",
    "deg/h/mT",
    "bias per magnetic field",
    Some(Influence::MagneticField),
    |m, compared| of_degree(m, compared, 1),
)
.signed();

/// Bias per supply voltage.
pub static SUPPLY_SENSITIVITY: Measurand = Measurand::of_influence(
    "supply_sensitivity",
    "deg/h/V",
    "bias per supply voltage",
    Some(Influence::Supply),
    |m, compared| of_degree(m, compared, 1),
)
.signed();

/// Bias per vibration power.
pub static VIBRATION_SENSITIVITY: Measurand = Measurand::of_influence(
    "vibration_sensitivity",
    "deg/h/g^2",
    "bias per vibration power",
    Some(Influence::Vibration),
    |m, compared| of_degree(m, compared, 2),
)
.signed();

/// Bias per level of a declared influence.
pub static INFLUENCE_SENSITIVITY: Measurand = Measurand::of_influence(
    "influence_sensitivity",
    "",
    "bias per level of a declared influence",
    Some(Influence::Declared),
    per_level,
)
.recorded_in(BIAS_PER_LEVEL)
.signed();

/// Bias per square of the level of a declared influence.
pub static INFLUENCE_SENSITIVITY_QUADRATIC: Measurand = Measurand::of_influence(
    "influence_sensitivity_quadratic",
    "",
    "bias per square of the level of a declared influence",
    Some(Influence::Declared),
    per_level,
)
.recorded_in(BIAS_PER_SQUARE)
.signed();

/// Change of the bias at every level.
pub static BIAS_SHIFT: Measurand = Measurand::of_influence(
    "bias_shift",
    "deg/h",
    "change of the bias at one level of an influence",
    None,
    |m, compared| shifts(m, compared.bias, &compared.bias.bias, true),
)
.signed();

/// Scale factor per level of a declared influence.
pub static SCALE_FACTOR_INFLUENCE_SENSITIVITY: Measurand = Measurand::of_influence(
    "scale_factor_influence_sensitivity",
    "",
    "scale factor per level of a declared influence",
    Some(Influence::Declared),
    per_level,
)
.recorded_in(SCALE_FACTOR_PER_LEVEL)
.signed();

/// Scale factor per square of the level of a declared influence.
pub static SCALE_FACTOR_INFLUENCE_SENSITIVITY_QUADRATIC: Measurand = Measurand::of_influence(
    "scale_factor_influence_sensitivity_quadratic",
    "",
    "scale factor per square of the level of a declared influence",
    Some(Influence::Declared),
    per_level,
)
.recorded_in(SCALE_FACTOR_PER_SQUARE)
.signed();

/// Change of the scale factor at every level of a declared influence.
pub static SCALE_FACTOR_SHIFT: Measurand = Measurand::of_influence(
    "scale_factor_shift",
    "ppm",
    "change of the scale factor at one level of a declared influence",
    Some(Influence::Declared),
    |m, compared| {
        let of = |effect| shifts(m, compared.bias, effect, false);
        compared.bias.scale_factor.as_ref().map_or(vec![], of)
    },
)
.signed();

pub(super) const METHOD: &str = "alternating_intervals";

/// What a measurand tells per level of a declared influence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PerLevel {
    /// Degree of the level.
    pub degree: u8,
    /// True for the scale factor, false for the bias.
    pub on_scale_factor: bool,
}

impl PerLevel {
    /// That of a measurand; `None` for one that is not told per level of a declared influence.
    pub fn of(m: &Measurand) -> Option<PerLevel> {
        let of = |degree, on_scale_factor| Some(PerLevel { degree, on_scale_factor });
        match m {
            m if *m == INFLUENCE_SENSITIVITY => of(1, false),
            m if *m == INFLUENCE_SENSITIVITY_QUADRATIC => of(2, false),
            m if *m == SCALE_FACTOR_INFLUENCE_SENSITIVITY => of(1, true),
            m if *m == SCALE_FACTOR_INFLUENCE_SENSITIVITY_QUADRATIC => of(2, true),
            _ => None,
        }
    }

    /// Its unit with a unit of the level.
    pub fn unit(self, level: &LevelUnit) -> &'static str {
        let units = if self.on_scale_factor { level.scale_factor } else { level.bias };
        if self.degree == 2 { units[1] } else { units[0] }
    }
}

/// Rows of a declared influence, whose unit follows from that of its level.
fn per_level(m: &Measurand, compared: &ComparisonEvidence<'_>) -> Vec<Estimate> {
    let of = PerLevel::of(m).zip(compared.bias.test.setting.unit);
    of.map_or(vec![], |(per, level)| terms(m, compared.bias, per, per.unit(level)))
}

/// Rows of an influence on the bias with a unit of its own.
fn of_degree(m: &Measurand, compared: &ComparisonEvidence<'_>, degree: u8) -> Vec<Estimate> {
    terms(m, compared.bias, PerLevel { degree, on_scale_factor: false }, m.unit)
}

/// One row an axis.
fn terms(
    m: &Measurand,
    found: &Comparison,
    PerLevel { degree, on_scale_factor }: PerLevel,
    unit: &'static str,
) -> Vec<Estimate> {
    let Some(effect) = (if on_scale_factor { found.scale_factor.as_ref() } else { Some(&found.bias) }) else {
        return vec![];
    };
    let own = effect.terms.iter().enumerate().filter(|(_, t)| t.degree == degree || !t.told_apart);
    let one = |(at, term): (usize, &Term)| {
        let c = &term.per_unit;
        let degrees = found.temperature.as_ref().and_then(|t| t.per_drive.get(at));
        // The degree of the level: a relative uncertainty of the level counts as often in its power.
        let of_level = Component::of(
            InputQuantity::InfluenceLevel,
            found.test.level_uncertainty,
            "1",
            f64::from(degree) * c.value,
        );
        let place = found.place(&term.axis, None);
        let row = if !term.told_apart {
            m.not_identifiable(&place, None, METHOD).note(note!("compared.few_levels"))
        } else if on_scale_factor {
            row(m, found, &place, c, &[of_level])
        } else {
            row(m, found, &place, c, &[of_level, of_temperature(found, degrees)])
        };
        Estimate { unit, ..row }
    };
    own.map(one).collect()
}

/// One row a level.
fn shifts(m: &Measurand, found: &Comparison, effect: &Effect, warms: bool) -> Vec<Estimate> {
    let rows = effect.shifts.iter().enumerate().map(|(at, s)| {
        let degrees = found.temperature.as_ref().and_then(|t| t.shifts.get(at));
        let others = [of_temperature(found, degrees)];
        let others = if warms { &others[..] } else { &[] };
        row(m, found, &found.place(&s.axis, Some(s.level)), &s.change, others)
    });
    rows.collect()
}

/// Largest effect of a difference of temperature on the bias, all smaller ones as likely.
pub(super) fn of_temperature(found: &Comparison, degrees: Option<&f64>) -> Component {
    let coefficient = found.test.temperature_coefficient.unwrap_or(0.0);
    let standard_deg_c = degrees.map_or(0.0, |d| d.abs()) / 3f64.sqrt();
    Component::of(InputQuantity::TemperatureDifference, standard_deg_c, "degC", coefficient)
}

pub(super) fn row(
    m: &Measurand,
    found: &Comparison,
    place: &str,
    c: &Combination,
    others: &[Component],
) -> Estimate {
    let row = if found.confounded() || found.unsettled() {
        m.not_identifiable(place, None, METHOD)
    } else {
        m.measured(place, c.value, spread(c, 1.0, others), METHOD).components(others)
    };
    remarks(found).into_iter().fold(row, Estimate::note)
}

/// What a reader must know of the intervals.
fn remarks(found: &Comparison) -> Vec<Note> {
    let with = found.intervals.iter().filter(|i| !i.off).count();
    let key = if found.drift { "compared.intervals" } else { "compared.intervals_no_drift" };
    let without = found.intervals.len() - with;
    let mut notes = vec![Note::new(key).with("without", without).with("with", with)];
    if found.scatter {
        notes.push(note!("compared.scatter"));
    }
    notes.extend(late(found));
    if let Some(d) = found.too_warm() {
        notes.push(note!("compared.warmer", difference = Arg::figures(d.abs(), 2)));
    } else if let Some(t) = found.temperature.as_ref().filter(|t| t.follows()) {
        let difference = Arg::figures(t.difference().abs(), 2);
        notes.push(match found.test.temperature_coefficient {
            Some(c) => note!("compared.allowed_for", difference, coefficient = Arg::figures(c, 3)),
            None => note!("compared.not_allowed_for", difference),
        });
    }
    notes.extend(found.disturbing().map(|other| other.note("compared.in_step")));
    notes
}

/// Note on the samples that the values are of, where the bias followed the level late and had settled.
fn late(found: &Comparison) -> Option<Note> {
    let response = found.response.as_ref().filter(|r| !r.goes_on())?;
    Some(note!("compared.responded", time_constant = Arg::figures(response.time_constant_s, 2)))
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{combination, near, notes, number, shows, student, withholds};
    use super::*;
    use crate::influence::comparison::{IntervalMean, Shift};
    use crate::influence::nuisance::{Following, Nuisance};
    use crate::influence::response::{ByMeans, Response};
    use crate::influence::setup::ComparisonTest;
    use crate::influence::setup::{Law, Setting};

    fn following(temperature: bool, shifts: [f64; 2], by_chance: f64) -> Following {
        let what = Nuisance { channel: "beside".into(), unit: "degC", temperature };
        Following { what, shifts: shifts.to_vec(), per_drive: vec![0.5, -2.0], by_chance }
    }

    fn interval(off: bool) -> IntervalMean {
        IntervalMean {
            name: String::new(),
            span_s: (0.0, 1.0),
            row: 1,
            level: 0.0,
            axis: String::new(),
            off,
            mean: combination(0.0, 1.0),
            temperature: f64::NAN,
        }
    }

    fn compared(setting: Setting) -> Comparison {
        let degree = setting.law.degrees()[0];
        let test = ComparisonTest {
            setting,
            reference: 0.0,
            settling_s: 0.0,
            rate_settling_s: 0.0,
            minimum_interval_s: 1.0,
            alternations: 1,
            level_uncertainty: 0.02,
            temperature_difference_deg_c: 1.0,
            temperature_coefficient: Some(0.06),
            declared: false,
            temperature: None,
            intervals: vec![],
            by_frequency: None,
        };
        let shift =
            |axis: &str, level, value| Shift { axis: axis.into(), level, change: combination(value, 0.03) };
        Comparison {
            channel: "g".into(),
            test,
            bias: Effect {
                terms: vec![
                    term("x", degree, combination(-2.0, 0.03)),
                    term("y", degree, combination(0.5, 0.04)),
                ],
                shifts: vec![shift("x", 2.0, -4.0), shift("y", 1.0, 0.5)],
                line: None,
            },
            scale_factor: None,
            intervals: vec![interval(true), interval(false), interval(true), interval(false), interval(true)],
            without: combination(12.0, 0.01),
            drift: true,
            scatter: false,
            response: None,
            moves_before: None,
            by_means: vec![],
            temperature: Some(following(true, [0.3, -0.6], 0.5)),
            others: vec![],
        }
    }

    fn term(axis: &str, degree: u8, per_unit: Combination) -> Term {
        Term { axis: axis.into(), degree, told_apart: true, per_unit }
    }

    fn rows(m: &Measurand, bias: &Comparison) -> Vec<Estimate> {
        m.evaluate_comparison(&ComparisonEvidence { bias, noise: &[], by_frequency: None })
    }

    #[test]
    fn a_sensitivity_has_a_row_an_axis_with_level_and_temperature() {
        for (m, setting, degree) in [
            (&MAGNETIC_SENSITIVITY, Setting::magnetic_field(), 1.0),
            (&SUPPLY_SENSITIVITY, Setting::supply(), 1.0),
            (&VIBRATION_SENSITIVITY, Setting::vibration(), 2.0),
        ] {
            let found = rows(m, &compared(setting.clone()));
            assert_eq!(found.iter().map(|r| r.channel.as_str()).collect::<Vec<_>>(), ["g@x", "g@y"]);
            shows(&found[0], -2.0, "alternating_intervals");
            shows(&found[1], 0.5, "alternating_intervals");
            // 2 % of the level, twice for its square; 0.06 deg/h/degC of the degrees per unit, evenly.
            let level = 0.02 * degree;
            let u = |random: f64, value: f64, degrees: f64| {
                (random * random + (level * value).powi(2) + (0.06 * degrees).powi(2) / 3.0).sqrt()
            };
            near(student(&found[0]).0, u(0.03, 2.0, 0.5));
            near(student(&found[1]).0, u(0.04, 0.5, 2.0));
            assert_eq!(notes(&found[0]), ["compared.intervals"]);
            assert_eq!(number(&found[0], "compared.intervals", "without"), 3.0);
            assert_eq!(number(&found[0], "compared.intervals", "with"), 2.0);
            for other in [&MAGNETIC_SENSITIVITY, &SUPPLY_SENSITIVITY, &VIBRATION_SENSITIVITY] {
                assert_eq!(rows(other, &compared(setting.clone())).is_empty(), other != m);
            }
        }
    }

    fn declared(law: Law, on_scale_factor: bool) -> Setting {
        let unit = LevelUnit::of("kPa");
        let influence = Influence::Declared;
        Setting { influence, unit, law, name: "baro".into(), on_scale_factor, ..Setting::supply() }
    }

    #[test]
    fn a_declared_influence_has_a_row_a_term_in_the_unit_of_its_level() {
        let mut found = compared(declared(Law::LinearQuadratic, true));
        found.temperature = None;
        found.bias.terms =
            vec![term("baro", 1, combination(-2.0, 0.03)), term("baro", 2, combination(0.5, 0.04))];
        found.scale_factor = Some(Effect {
            terms: vec![term("baro", 1, combination(3.0, 0.1)), term("baro", 2, combination(0.2, 0.1))],
            shifts: vec![Shift { axis: "baro".into(), level: 2.0, change: combination(7.0, 0.5) }],
            line: None,
        });
        for (m, value, u, unit) in [
            (&INFLUENCE_SENSITIVITY, -2.0, 0.03f64.hypot(0.02 * 2.0), "deg/h/kPa"),
            (&INFLUENCE_SENSITIVITY_QUADRATIC, 0.5, 0.04f64.hypot(0.04 * 0.5), "deg/h/kPa^2"),
            (&SCALE_FACTOR_INFLUENCE_SENSITIVITY, 3.0, 0.1f64.hypot(0.02 * 3.0), "ppm/kPa"),
            (&SCALE_FACTOR_INFLUENCE_SENSITIVITY_QUADRATIC, 0.2, 0.1f64.hypot(0.04 * 0.2), "ppm/kPa^2"),
        ] {
            let own = rows(m, &found);
            assert_eq!(own.len(), 1, "{}", m.id);
            shows(&own[0], value, "alternating_intervals");
            near(student(&own[0]).0, u);
            assert_eq!((own[0].unit, own[0].channel.as_str()), (unit, "g@baro"));
            assert!(m.recorded_in.contains(&unit), "{unit}");
        }
        let shift = &rows(&SCALE_FACTOR_SHIFT, &found)[0];
        shows(shift, 7.0, "alternating_intervals");
        assert_eq!((shift.unit, shift.channel.as_str()), ("ppm", "g@baro:2"));
        // A table that was not asked for shows no scale factor.
        found.scale_factor = None;
        assert!(rows(&SCALE_FACTOR_SHIFT, &found).is_empty());
        assert!(rows(&SCALE_FACTOR_INFLUENCE_SENSITIVITY, &found).is_empty());
    }

    #[test]
    fn terms_that_one_level_cannot_tell_apart_have_no_value() {
        let mut found = compared(declared(Law::LinearQuadratic, false));
        found.bias.terms = vec![Term { told_apart: false, ..term("baro", 1, combination(-2.0, 0.03)) }];
        for m in [&INFLUENCE_SENSITIVITY, &INFLUENCE_SENSITIVITY_QUADRATIC] {
            let own = rows(m, &found);
            assert_eq!(own.len(), 1);
            withholds(&own[0], None, "alternating_intervals");
            assert_eq!(notes(&own[0]), ["compared.few_levels"]);
        }
        assert!(rows(&BIAS_SHIFT, &found)[0].value.is_some());
    }

    #[test]
    fn a_shift_has_a_row_a_level_without_the_uncertainty_of_the_level() {
        let mut found = compared(Setting::vibration());
        let shifts = rows(&BIAS_SHIFT, &found);
        assert_eq!(shifts.iter().map(|r| r.channel.as_str()).collect::<Vec<_>>(), ["g@x:2", "g@y:1"]);
        shows(&shifts[0], -4.0, "alternating_intervals");
        near(student(&shifts[0]).0, (9e-4f64 + (0.06f64 * 0.3).powi(2) / 3.0).sqrt());
        near(student(&shifts[1]).0, (9e-4f64 + (0.06f64 * 0.6).powi(2) / 3.0).sqrt());
        // Without a coefficient or a temperature only the scatter is left.
        found.test.temperature_coefficient = None;
        near(student(&rows(&BIAS_SHIFT, &found)[0]).0, 0.03);
        found.temperature = None;
        near(student(&rows(&BIAS_SHIFT, &found)[1]).0, 0.03);
    }

    #[test]
    fn remarks_say_what_went_with_the_levels() {
        let mut found = compared(Setting::supply());
        (found.drift, found.scatter) = (false, true);
        assert_eq!(notes(&rows(&BIAS_SHIFT, &found)[0]), ["compared.intervals_no_drift", "compared.scatter"]);
        (found.drift, found.scatter) = (true, false);
        // A temperature that follows within what is allowed: from −0.8 to 0.1.
        found.temperature = Some(following(true, [0.1, -0.8], 1e-6));
        let row = &rows(&BIAS_SHIFT, &found)[0];
        assert_eq!(notes(row), ["compared.intervals", "compared.allowed_for"]);
        near(number(row, "compared.allowed_for", "difference"), 0.9);
        near(number(row, "compared.allowed_for", "coefficient"), 0.06);
        found.test.temperature_coefficient = None;
        let row = &rows(&BIAS_SHIFT, &found)[0];
        near(number(row, "compared.not_allowed_for", "difference"), 0.9);
        // Beyond what is allowed nothing is stated.
        found.temperature = Some(following(true, [0.4, -0.8], 1e-6));
        let row = &rows(&BIAS_SHIFT, &found)[0];
        withholds(row, None, "alternating_intervals");
        near(number(row, "compared.warmer", "difference"), 1.2);
        found.temperature = None;
        found.others = vec![following(false, [0.1, 0.0], 0.5), following(false, [0.1, 0.0], 1e-6)];
        let row = &rows(&BIAS_SHIFT, &found)[0];
        withholds(row, None, "alternating_intervals");
        assert_eq!(notes(row), ["compared.intervals", "compared.in_step"]);
    }

    #[test]
    fn a_response_that_goes_on_and_means_that_contradict_leave_no_value() {
        let mut found = compared(Setting::supply());
        let contradiction = |found: &Comparison| {
            let row = rows(&SUPPLY_SENSITIVITY, found).remove(0);
            withholds(&row, None, "alternating_intervals");
            let only = row.objections.first().map(|o| (o.check, o.finding.found.id.clone()));
            assert_eq!(row.objections.len(), 1, "{row:?}");
            only.map_or(String::new(), |(check, id)| format!("{check}: {id}"))
        };
        let differing =
            |means: f64| ByMeans { means: combination(means, 0.03), model: combination(-2.0, 0.03) };
        found.by_means = vec![differing(-1.8)];
        assert_eq!(contradiction(&found), "response: criticism_found.interval_means");
        found.by_means = vec![differing(-1.95)];
        shows(&rows(&SUPPLY_SENSITIVITY, &found)[0], -2.0, "alternating_intervals");
        // A response that is seen explains the means.
        found.by_means = vec![differing(-1.8)];
        found.response = Some(Response { time_constant_s: 60.0, remaining: 0.13 });
        assert_eq!(contradiction(&found), "response: criticism_found.still_responding");
        found.response = Some(Response { time_constant_s: 20.0, remaining: 0.002 });
        let row = rows(&SUPPLY_SENSITIVITY, &found).remove(0);
        assert_eq!(notes(&row)[1], "compared.responded");
        assert!(row.objections.is_empty() && row.value.is_some());
    }
}
