//! What an influence changes the bias by: per unit of the influence, and at every level.

use super::descriptor::Measurand;
use super::evidence::ComparisonEvidence;
use crate::estimate::{Component, Estimate, InputQuantity};
use crate::influence::Influence;
use crate::influence::comparison::Comparison;
use crate::message::{Arg, Note, note};
use crate::numeric::reml::Combination;
use crate::rate_table::combine::spread;

/// Bias per magnetic field.
pub static MAGNETIC_SENSITIVITY: Measurand = Measurand::of_influence(
    "magnetic_sensitivity",
    "deg/h/mT",
    "bias per magnetic field",
    Some(Influence::MagneticField),
    sensitivity,
)
.signed();

/// Bias per supply voltage.
pub static SUPPLY_SENSITIVITY: Measurand = Measurand::of_influence(
    "supply_sensitivity",
    "deg/h/V",
    "bias per supply voltage",
    Some(Influence::Supply),
    sensitivity,
)
.signed();

/// Bias per vibration power.
pub static VIBRATION_SENSITIVITY: Measurand = Measurand::of_influence(
    "vibration_sensitivity",
    "deg/h/g^2",
    "bias per vibration power",
    Some(Influence::Vibration),
    sensitivity,
)
.signed();

/// Change of the bias at every level.
pub static BIAS_SHIFT: Measurand = Measurand::of_influence(
    "bias_shift",
    "deg/h",
    "change of the bias at one level of an influence",
    None,
    shift,
)
.signed();

const METHOD: &str = "alternating_intervals";

/// One row an axis.
fn sensitivity(m: &Measurand, compared: &ComparisonEvidence<'_>) -> Vec<Estimate> {
    let found = compared.bias;
    let rows = found.axes.iter().zip(&found.per_unit).enumerate().map(|(at, (axis, c))| {
        let degrees = found.temperature.as_ref().and_then(|t| t.per_drive.get(at));
        // The degree of the level: a relative uncertainty of the level counts as often in its power.
        let of_level = Component::of(
            InputQuantity::InfluenceLevel,
            found.test.level_uncertainty,
            "1",
            found.test.influence.degree() * c.value,
        );
        row(m, found, &found.place(axis, None), c, &[of_level, of_temperature(found, degrees)])
    });
    rows.collect()
}

/// One row a level.
fn shift(m: &Measurand, compared: &ComparisonEvidence<'_>) -> Vec<Estimate> {
    let found = compared.bias;
    let rows = found.shifts.iter().enumerate().map(|(at, s)| {
        let degrees = found.temperature.as_ref().and_then(|t| t.shifts.get(at));
        row(m, found, &found.place(&s.axis, Some(s.level)), &s.change, &[of_temperature(found, degrees)])
    });
    rows.collect()
}

/// Largest effect of a difference of temperature on the bias, all smaller ones as likely.
fn of_temperature(found: &Comparison, degrees: Option<&f64>) -> Component {
    let coefficient = found.test.temperature_coefficient.unwrap_or(0.0);
    let standard_deg_c = degrees.map_or(0.0, |d| d.abs()) / 3f64.sqrt();
    Component::of(InputQuantity::TemperatureDifference, standard_deg_c, "degC", coefficient)
}

fn row(m: &Measurand, found: &Comparison, place: &str, c: &Combination, others: &[Component]) -> Estimate {
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

    fn compared(influence: Influence) -> Comparison {
        let test = ComparisonTest {
            influence,
            reference: 0.0,
            settling_s: 0.0,
            minimum_interval_s: 1.0,
            alternations: 1,
            level_uncertainty: 0.02,
            temperature_difference_deg_c: 1.0,
            temperature_coefficient: Some(0.06),
            declared: false,
            temperature: None,
            intervals: vec![],
        };
        let shift =
            |axis: &str, level, value| Shift { axis: axis.into(), level, change: combination(value, 0.03) };
        Comparison {
            channel: "g".into(),
            test,
            axes: vec!["x".into(), "y".into()],
            per_unit: vec![combination(-2.0, 0.03), combination(0.5, 0.04)],
            shifts: vec![shift("x", 2.0, -4.0), shift("y", 1.0, 0.5)],
            intervals: vec![interval(true), interval(false), interval(true), interval(false), interval(true)],
            without: combination(12.0, 0.01),
            line: None,
            drift: true,
            scatter: false,
            response: None,
            by_means: vec![],
            temperature: Some(following(true, [0.3, -0.6], 0.5)),
            others: vec![],
        }
    }

    fn rows(m: &Measurand, bias: &Comparison) -> Vec<Estimate> {
        m.evaluate_comparison(&ComparisonEvidence { bias, noise: &[] })
    }

    #[test]
    fn a_sensitivity_has_a_row_an_axis_with_level_and_temperature() {
        for (m, influence, degree) in [
            (&MAGNETIC_SENSITIVITY, Influence::MagneticField, 1.0),
            (&SUPPLY_SENSITIVITY, Influence::Supply, 1.0),
            (&VIBRATION_SENSITIVITY, Influence::Vibration, 2.0),
        ] {
            let found = rows(m, &compared(influence));
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
                assert_eq!(rows(other, &compared(influence)).is_empty(), other != m);
            }
        }
    }

    #[test]
    fn a_shift_has_a_row_a_level_without_the_uncertainty_of_the_level() {
        let mut found = compared(Influence::Vibration);
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
        let mut found = compared(Influence::Supply);
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
        let mut found = compared(Influence::Supply);
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
