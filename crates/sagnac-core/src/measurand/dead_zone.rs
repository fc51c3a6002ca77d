//! Response to rates near zero: half width of the dead zone, the noise inside the loop, threshold, resolution.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::message::{Arg, Note};
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
            m.not_identifiable(&z.channel, limit, "smallest_step_shown")
                .note(Note::new("dead_zone.resolution"))
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
        let note = Note::new("dead_zone.no_form").with("percent", Arg::figures(100.0 * chance, 2));
        return vec![at_most(m, z, None).note(note)];
    }
    if let Some(most) = z.open {
        return vec![
            at_most(m, z, None).note(Note::new("dead_zone.open").with("most", Arg::figures(most, 3))),
        ];
    }
    if let Some((share, most)) = z.follows.and_then(|(share, most)| Some((share, passes(most)?))) {
        let note = Note::new("dead_zone.follows").with("percent", Arg::figures(100.0 * share, 2));
        return vec![at_most(m, z, most).note(note)];
    }
    let row = of(m, z);
    vec![match z.scale_factor_known {
        Some(u) => row.note(Note::new("dead_zone_known.scale_factor").with("ppm", Arg::figures(1e6 * u, 3))),
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
        return at_most(m, z, Some(value)).note(Note::new("dead_zone_noise.half_of_any"));
    }
    of_zone(m, z, value, &z.threshold)
}

fn noise(m: &Measurand, z: &DeadZone) -> Estimate {
    match &z.rounded {
        Some(r) => {
            let spread = Spread::Curve(r.noise.clone());
            m.measured(&z.channel, median(&r.noise), spread, METHOD).note(Note::new("dead_zone_noise.shown"))
        }
        None if z.half_width.is_some() && z.noise_bound.is_none() => {
            at_most(m, z, None).note(Note::new("dead_zone_noise.other_form"))
        }
        None if z.half_width.is_some() => {
            at_most(m, z, z.noise_bound).note(Note::new("dead_zone_noise.not_shown"))
        }
        None => at_most(m, z, None).note(Note::new("dead_zone_noise.no_zone")),
    }
}

/// What a zone that is not shown is at most, and what would show less.
fn bounded(m: &Measurand, z: &DeadZone, value: f64) -> Estimate {
    let found = at_most(m, z, Some(value));
    match z.between {
        Some((smallest, apart)) => found.note(
            Note::new("dead_zone_noise.between_rates")
                .with("smallest", Arg::figures(smallest, 2))
                .with("apart", Arg::figures(apart, 2)),
        ),
        None => found,
    }
}

fn at_most(m: &Measurand, z: &DeadZone, value: Option<f64>) -> Estimate {
    m.not_identifiable(&z.channel, value.map(|value| UpperLimit { value, coverage: 0.95 }), METHOD)
}

/// What a zone that is shown has.
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
        found.note(Note::new("dead_zone.forms").with("n", z.others))
    } else {
        found
    }
}
