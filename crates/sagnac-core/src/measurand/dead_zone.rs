//! Response to rates near zero: half width of the dead zone, the noise inside the loop, threshold, resolution.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::message::{Arg, Note, note};
use crate::rate_table::dead_zone::{DeadZone, Kind, median};

/// Half width of the zone without response.
pub static DEAD_ZONE: Measurand = Measurand::of_steps(
    "dead_zone",
    "deg/h",
    "half width of the zone without response",
    Stimulus::SmallRates,
    |m, e| of_form(m, e, Some, half_width),
);

/// Noise inside the loop.
pub static DEAD_ZONE_NOISE: Measurand = Measurand::of_steps(
    "dead_zone_noise",
    "deg/h",
    "standard deviation of the rate noise inside the loop, which rounds the dead zone off",
    Stimulus::SmallRates,
    // Noise in the loop is only one way to answer a little.
    |m, e| of_form(m, e, |most| most.is_none().then_some(None), noise),
);

/// Smallest rate that is shown.
pub static THRESHOLD: Measurand = Measurand::of_steps(
    "threshold",
    "deg/h",
    "smallest rate that is shown",
    Stimulus::SmallRates,
    // Where half comes through is read from the form.
    |m, e| of_form(m, e, |_| Some(None), threshold),
);

/// Smallest change of rate that is shown.
pub static RESOLUTION: Measurand = Measurand::of_steps(
    "resolution",
    "deg/h",
    "smallest change of rate that is shown",
    Stimulus::SmallRates,
    |m, e| {
        let row = |z: &DeadZone| {
            let limit = z.resolution.map(|value| UpperLimit { value, coverage: 0.95 });
            m.not_identifiable(&z.channel, limit, "smallest_step_shown").note(note!("dead_zone.resolution"))
        };
        e.dead_zone.as_ref().map(row).into_iter().collect()
    },
);

const METHOD: &str = "profile_likelihood";

/// A row that is read from the form of the zone, where one form fits and the zone ends inside the test.
///
/// `passes` is asked where the noise inside the loop lets so much of the smallest rates through that there is no dead zone.
/// It gets what the half width is at most, and gives what the measurand is at most; `None`: the measurand is shown all the
/// same.
fn of_form(
    m: &Measurand,
    e: &TableEvidence<'_>,
    passes: fn(Option<f64>) -> Option<Option<f64>>,
    of: fn(&Measurand, &DeadZone) -> Estimate,
) -> Vec<Estimate> {
    let Some(z) = &e.dead_zone else { return vec![] };
    if let Some(chance) = z.unexplained {
        let note = note!("dead_zone.no_form", percent = Arg::figures(100.0 * chance, 2));
        return vec![at_most(m, z, None).note(note)];
    }
    if let Some(most) = z.open {
        return vec![at_most(m, z, None).note(note!("dead_zone.open", most = Arg::figures(most, 3)))];
    }
    if let Some((share, most)) = z.follows.and_then(|(share, most)| Some((share, passes(most)?))) {
        let note = note!("dead_zone.follows", percent = Arg::figures(100.0 * share, 2));
        return vec![at_most(m, z, most).note(note)];
    }
    let row = of(m, z);
    vec![match z.scale_factor_known {
        Some(u) => row.note(note!("dead_zone_known.scale_factor", ppm = Arg::figures(1e6 * u, 3))),
        None => row,
    }]
}

fn half_width(m: &Measurand, z: &DeadZone) -> Estimate {
    match z.half_width {
        Some(value) => of_zone(m, z, value, &z.curve),
        None => bounded(m, z, z.bound.0),
    }
}

fn threshold(m: &Measurand, z: &DeadZone) -> Estimate {
    if z.half_width.is_none() {
        return bounded(m, z, z.bound.1);
    }
    let value = median(&z.threshold);
    if value <= 0.0 {
        let value = Spread::Curve(z.threshold.clone()).bound(0.0, 0.95).unwrap_or(0.0);
        return at_most(m, z, Some(value)).note(note!("dead_zone_noise.half_of_any"));
    }
    of_zone(m, z, value, &z.threshold)
}

fn noise(m: &Measurand, z: &DeadZone) -> Estimate {
    match &z.rounded {
        Some(r) => {
            let spread = Spread::Curve(r.noise.clone());
            m.measured(&z.channel, median(&r.noise), spread, METHOD).note(note!("dead_zone_noise.shown"))
        }
        None if z.half_width.is_some() && z.noise_bound.is_none() => {
            at_most(m, z, None).note(note!("dead_zone_noise.other_form"))
        }
        None if z.half_width.is_some() => {
            at_most(m, z, z.noise_bound).note(note!("dead_zone_noise.not_shown"))
        }
        None => at_most(m, z, None).note(note!("dead_zone_noise.no_zone")),
    }
}

/// Upper limit of a zone that is not shown, and the test that would show less.
fn bounded(m: &Measurand, z: &DeadZone, value: f64) -> Estimate {
    let found = at_most(m, z, Some(value));
    match z.between {
        Some((smallest, apart)) => found.note(note!(
            "dead_zone_noise.between_rates",
            smallest = Arg::figures(smallest, 2),
            apart = Arg::figures(apart, 2)
        )),
        None => found,
    }
}

fn at_most(m: &Measurand, z: &DeadZone, value: Option<f64>) -> Estimate {
    m.not_identifiable(&z.channel, value.map(|value| UpperLimit { value, coverage: 0.95 }), METHOD)
}

/// Estimates of a zone that is shown.
fn of_zone(m: &Measurand, z: &DeadZone, value: f64, curve: &[(f64, f64)]) -> Estimate {
    let key = match z.shape.kind {
        Kind::Subtractive => "dead_zone.subtractive",
        Kind::Gap => "dead_zone.gap",
        Kind::Locked => "dead_zone.locked",
        Kind::Rounded => "dead_zone_noise.rounded",
    };
    let found = m
        .measured(&z.channel, value, Spread::Curve(curve.to_vec()), METHOD)
        .note(Note::new(key).with("centre", Arg::figures(z.centre, 3)));
    if z.others > 0 && z.rounded.is_none() {
        found.note(note!("dead_zone.forms", n = z.others))
    } else {
        found
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{curve, near, notes, number, on_table, shows, steps, withholds};
    use super::*;
    use crate::rate_table::Setup;
    use crate::rate_table::dead_zone::evaluate;
    use crate::rate_table::model;
    use crate::rate_table::steps::Steps;
    use std::sync::LazyLock;

    /// A zone as a test of small rates leaves it, which takes a while to find.
    static FOUND: LazyLock<DeadZone> = LazyLock::new(|| {
        let rates: Vec<f64> = (-2..=2).map(|i| 6.0 * f64::from(i)).collect();
        let outputs: Vec<f64> = rates.iter().map(|r| if r.abs() > 5.0 { *r } else { 0.0 }).collect();
        let (setup, steps) = (Setup::default(), steps(&rates, &outputs, rates.len()));
        let response = model::fit(&steps, 0, &setup, &[]).unwrap();
        evaluate(&steps, 0, &response, "g", &setup).unwrap()
    });

    /// The same with numbers of its own.
    fn zone() -> DeadZone {
        let mut z = FOUND.clone();
        (z.half_width, z.centre, z.bound) = (Some(5.0), 0.25, (6.0, 7.0));
        (z.unexplained, z.open, z.others, z.rounded, z.follows) = (None, None, 0, None, None);
        z.curve = vec![(-2.0, 4.0), (0.0, 5.0), (2.0, 6.0)];
        z.threshold = vec![(-2.0, 8.0), (0.0, 10.0), (2.0, 12.0)];
        (z.noise_bound, z.between, z.resolution, z.scale_factor_known) = (Some(1.5), None, Some(3.0), None);
        z.shape.kind = Kind::Gap;
        z
    }

    fn row(m: &Measurand, z: &DeadZone) -> Estimate {
        let (setup, steps) = (Setup::default(), Steps::default());
        assert!(m.evaluate_steps(&on_table(&setup, &steps, None)).is_empty());
        let e = TableEvidence { dead_zone: Some(z.clone()), ..on_table(&setup, &steps, None) };
        let mut rows = m.evaluate_steps(&e);
        assert_eq!(rows.len(), 1);
        rows.remove(0)
    }

    #[test]
    fn a_zone_that_is_shown_has_its_half_width_and_threshold() {
        let mut z = zone();
        for (kind, note) in [
            (Kind::Gap, "dead_zone.gap"),
            (Kind::Subtractive, "dead_zone.subtractive"),
            (Kind::Locked, "dead_zone.locked"),
            (Kind::Rounded, "dead_zone_noise.rounded"),
        ] {
            z.shape.kind = kind;
            let found = row(&DEAD_ZONE, &z);
            shows(&found, 5.0, METHOD);
            assert_eq!((notes(&found), number(&found, note, "centre")), (vec![note], 0.25));
            assert_eq!(curve(&found), z.curve);
        }
        let found = row(&THRESHOLD, &z);
        shows(&found, 10.0, METHOD);
        assert_eq!(curve(&found), z.threshold);
        z.others = 2;
        let found = row(&DEAD_ZONE, &z);
        assert_eq!(number(&found, "dead_zone.forms", "n"), 2.0);
        z.scale_factor_known = Some(2e-5);
        near(number(&row(&DEAD_ZONE, &z), "dead_zone_known.scale_factor", "ppm"), 20.0);
        let resolution = row(&RESOLUTION, &z);
        withholds(&resolution, Some(3.0), "smallest_step_shown");
        assert_eq!(notes(&resolution), ["dead_zone.resolution"]);
    }

    #[test]
    fn a_zone_that_is_not_shown_is_bounded() {
        let mut z = DeadZone { half_width: None, ..zone() };
        withholds(&row(&DEAD_ZONE, &z), Some(6.0), METHOD);
        withholds(&row(&THRESHOLD, &z), Some(7.0), METHOD);
        assert_eq!(notes(&row(&DEAD_ZONE, &z)), [""; 0]);
        z.between = Some((2.0, 4.0));
        let found = row(&DEAD_ZONE, &z);
        assert_eq!(number(&found, "dead_zone_noise.between_rates", "smallest"), 2.0);
        assert_eq!(number(&found, "dead_zone_noise.between_rates", "apart"), 4.0);
        let noise = row(&DEAD_ZONE_NOISE, &z);
        withholds(&noise, None, METHOD);
        assert_eq!(notes(&noise), ["dead_zone_noise.no_zone"]);
        z.noise_bound = None;
        assert_eq!(notes(&row(&DEAD_ZONE_NOISE, &z)), ["dead_zone_noise.no_zone"]);
    }

    #[test]
    fn half_of_any_rate_comes_through_where_the_threshold_is_none() {
        // At 95 % the score 1.645 of a curve from 0 to 1 over two.
        let z = DeadZone { threshold: vec![(-2.0, 0.0), (0.0, 0.0), (2.0, 1.0)], ..zone() };
        let found = row(&THRESHOLD, &z);
        withholds(&found, Some(0.822_426_813_475_736_1), METHOD);
        assert_eq!(notes(&found), ["dead_zone_noise.half_of_any"]);
    }

    #[test]
    fn noise_that_is_not_shown_is_bounded_where_a_form_allows_it() {
        let z = zone();
        let found = row(&DEAD_ZONE_NOISE, &z);
        withholds(&found, Some(1.5), METHOD);
        assert_eq!(notes(&found), ["dead_zone_noise.not_shown"]);
        let other = row(&DEAD_ZONE_NOISE, &DeadZone { noise_bound: None, ..z });
        withholds(&other, None, METHOD);
        assert_eq!(notes(&other), ["dead_zone_noise.other_form"]);
    }

    #[test]
    fn where_no_form_fits_or_the_zone_is_open_nothing_is_stated() {
        let unexplained = DeadZone { unexplained: Some(0.002), ..zone() };
        let open = DeadZone { open: Some(16.0), ..zone() };
        for m in [&DEAD_ZONE, &DEAD_ZONE_NOISE, &THRESHOLD] {
            let found = row(m, &unexplained);
            withholds(&found, None, METHOD);
            near(number(&found, "dead_zone.no_form", "percent"), 0.2);
            let found = row(m, &open);
            withholds(&found, None, METHOD);
            assert_eq!(number(&found, "dead_zone.open", "most"), 16.0);
        }
    }

    #[test]
    fn noise_that_lets_small_rates_through_leaves_no_dead_zone() {
        for (most, width) in [(Some(4.0), Some(4.0)), (None, None)] {
            let z = DeadZone { follows: Some((0.3, most)), ..zone() };
            let found = row(&DEAD_ZONE, &z);
            withholds(&found, width, METHOD);
            near(number(&found, "dead_zone.follows", "percent"), 30.0);
            withholds(&row(&THRESHOLD, &z), None, METHOD);
            // The noise is withheld only where nothing bounds the zone.
            let noise = row(&DEAD_ZONE_NOISE, &z);
            let note = if most.is_some() { "dead_zone_noise.not_shown" } else { "dead_zone.follows" };
            assert_eq!(notes(&noise), [note]);
        }
    }
}
