//! Read-outs of a log-log plot: N, K, Q and R from a line of their slope through σ(τ).

use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, Spread, normal_probability};
use crate::message::{Arg, note};
use crate::noise::data::NoiseType;
use crate::noise::slope::{LARGEST_SHARE, SLOPE_TOLERANCE, SlopePoint, read, reading_time_s, slope};

/// N from a line of slope -1/2.
pub static ANGLE_RANDOM_WALK_READOUT: Measurand = Measurand::at_rest(
    "angle_random_walk_readout",
    "deg/sqrt(h)",
    "N at 1 h on a line of slope -1/2 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::AngleRandomWalk)],
)
.needs_stillness();

/// K from a line of slope +1/2.
pub static RATE_RANDOM_WALK_READOUT: Measurand = Measurand::at_rest(
    "rate_random_walk_readout",
    "deg/h/sqrt(h)",
    "K at 3 h on a line of slope +1/2 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::RateRandomWalk)],
)
.needs_stillness();

/// R from a line of slope +1.
pub static RATE_RAMP_READOUT: Measurand = Measurand::at_rest(
    "rate_ramp_readout",
    "deg/h/h",
    "R at sqrt(2) h on a line of slope +1 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::RateRamp)],
)
.needs_stillness();

/// Q from a line of slope -1.
pub static QUANTIZATION_READOUT: Measurand = Measurand::at_rest(
    "quantization_readout",
    "arcsec",
    "Q at sqrt(3) s on a line of slope -1 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::Quantization)],
)
.needs_stillness();

const METHOD: &str = "slope_readout";

/// Part of a reading that a term must make up for the reading to be taken as its own.
const ALONE: f64 = 0.98;

/// Part of a reading up to which the fit gives all of it to other terms.
const NOTHING: f64 = 0.1;
/// Points up to which a line at the end of a record may be one by chance: two octaves.
const FEW_POINTS: usize = 3;

fn read_out(m: &Measurand, gyro: &GyroEvidence, term: NoiseType) -> Estimate {
    let samples = gyro.digest.samples as f64;
    let points: Vec<SlopePoint> = gyro
        .octaves
        .iter()
        .filter(|p| p.point.m as f64 <= LARGEST_SHARE * samples && p.point.deviation > 0.0 && p.edf > 0.0)
        .map(|p| SlopePoint {
            tau_s: p.point.m as f64 * gyro.tau0_s,
            deviation: p.point.deviation,
            edf: p.edf,
        })
        .collect();
    let Some(found) = read(&points, term) else {
        return m.not_identifiable(&gyro.channel, None, METHOD).note(note!(
            "readout.no_slope",
            slope = Arg::Stated(slope(term)),
            tolerance = Arg::Stated(SLOPE_TOLERANCE)
        ));
    };
    let on_line: Vec<f64> = points.iter().map(|p| p.tau_s).collect();
    let own = own_part(gyro, term, on_line.iter().filter(|t| (found.from_s..=found.to_s).contains(*t)));
    // A slope of two octaves at the end of the record comes about by chance.
    let at_end = points.last().is_some_and(|p| p.tau_s <= found.to_s);
    if at_end && found.points <= FEW_POINTS && own < NOTHING {
        return m.not_identifiable(&gyro.channel, None, METHOD).note(note!(
            "readout.by_others",
            slope = Arg::Stated(slope(term)),
            from_s = found.from_s,
            to_s = found.to_s
        ));
    }
    let spread = reaching_down(Spread::ChiSquare { dof: found.dof }, found.value, own);
    let estimate = m.measured(&gyro.channel, found.value, spread, METHOD).note(note!(
        "readout.line",
        slope = Arg::Stated(slope(term)),
        tolerance = Arg::Stated(SLOPE_TOLERANCE),
        n = found.points,
        from_s = found.from_s,
        to_s = found.to_s,
        at_s = reading_time_s(term)
    ));
    if own < ALONE {
        return estimate.note(note!("readout.others", percent = Arg::figures(100.0 * (1.0 - own), 2)));
    }
    estimate
}

/// Part of a reading that the term itself makes up by the fitted description, 0 to 1: a line read off the curve holds a
/// part of every other term. 1 where nothing was fitted.
fn own_part<'a>(gyro: &GyroEvidence, term: NoiseType, tau_s: impl Iterator<Item = &'a f64>) -> f64 {
    let (model, tau0_s) = (&gyro.identification.described.model, gyro.tau0_s);
    let plateau = gyro.identification.plateau.as_ref().filter(|_| term == NoiseType::AngleRandomWalk);
    let alone = plateau.map_or_else(|| model.alone(term), |plateau| plateau.parts(model));
    let ratios: Vec<f64> = tau_s
        .map(|t| alone.allan_variance(*t, tau0_s) / model.allan_variance(*t, tau0_s))
        .filter(|r| r.is_finite())
        .map(|r| r.clamp(0.0, 1.0).sqrt())
        .collect();
    if ratios.is_empty() { 1.0 } else { ratios.iter().sum::<f64>() / ratios.len() as f64 }
}

/// A spread whose lower side reaches down to the term's own part of the reading.
fn reaching_down(spread: Spread, value: f64, own: f64) -> Spread {
    if own >= ALONE {
        return spread;
    }
    let scores = (-40..=40).map(|i| 0.1 * f64::from(i));
    let bounds = scores.filter_map(|z| {
        let bound = spread.bound(value, normal_probability(z))?;
        Some((z, if z < 0.0 { own * bound } else { bound }))
    });
    Spread::Curve(bounds.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_holds_other_terms_reaches_down_to_its_own_part() {
        let plain = Spread::ChiSquare { dof: 200.0 };
        assert_eq!(reaching_down(plain.clone(), 2.0, 1.0), plain);
        let (before, after) = (plain.interval(2.0, 0.95).unwrap(), {
            let wide = reaching_down(plain.clone(), 2.0, 0.8);
            wide.interval(2.0, 0.95).unwrap()
        });
        assert!((after.low - 0.8 * before.low).abs() < 1e-3 && (after.high - before.high).abs() < 1e-3);
    }

    use super::super::Options;
    use super::super::test_evidence::{
        chi_square, curve, gyro, near, notes, number, point, shows, withholds, within,
    };
    use crate::noise::composite::{Composite, Damped};
    use crate::noise::identification::Plateau;
    use crate::noise::model::NoiseModel;

    const N: f64 = 0.002;

    /// 10 000 samples at 0.5 s, of which m up to 1000 is read: octaves of a deviation.
    fn with(deviation: impl Fn(f64) -> f64) -> GyroEvidence {
        let mut gyro = gyro();
        gyro.digest.samples = 10_000;
        gyro.octaves = (0..10).map(|k| 1 << k).map(|m| point(m, deviation(0.5 * m as f64), 1000.0)).collect();
        gyro
    }

    fn white(tau_s: f64) -> f64 {
        60.0 * N / tau_s.sqrt()
    }

    fn row(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
        m.evaluate_gyro(gyro, &Options { remove_earth_rate: false }).remove(0)
    }

    #[test]
    fn n_is_read_at_an_hour_from_the_points_that_can_be_read() {
        let mut gyro = with(white);
        // On the same line and beyond a tenth of the record, or without a deviation or degrees of freedom.
        gyro.octaves.push(point(1001, white(500.5), 1000.0));
        gyro.octaves.insert(0, point(1, 0.0, 1000.0));
        gyro.octaves.push(point(700, white(350.0), 0.0));
        let found = row(&ANGLE_RANDOM_WALK_READOUT, &gyro);
        shows(&found, N, "slope_readout");
        let expected = [
            ("slope", -0.5),
            ("tolerance", 0.15),
            ("n", 10.0),
            ("from_s", 0.5),
            ("to_s", 256.0),
            ("at_s", 3600.0),
        ];
        for (name, value) in expected {
            near(number(&found, "readout.line", name), value);
        }
        assert_eq!(notes(&found), ["readout.line"]);
        // Ten points of 1000 degrees each, neighbours correlated by 0.52ᵈ.
        let correlated: f64 =
            (0..10).flat_map(|i: i32| (0..10).map(move |j: i32| 0.52f64.powi((i - j).abs()))).sum();
        within(chi_square(&found), 100.0 * 1000.0 / correlated, 1e-9);
        let none = row(&RATE_RANDOM_WALK_READOUT, &gyro);
        withholds(&none, None, "slope_readout");
        near(number(&none, "readout.no_slope", "slope"), 0.5);
        near(number(&none, "readout.no_slope", "tolerance"), 0.15);
    }

    #[test]
    fn every_term_has_its_slope_and_its_reading_time() {
        // σ = K√(τ/3), R τ/√2 (τ in h) and Q√3/τ (τ in s).
        let k = row(&RATE_RANDOM_WALK_READOUT, &with(|t| 0.3 * (t / 10_800.0).sqrt()));
        shows(&k, 0.3, "slope_readout");
        shows(&row(&RATE_RAMP_READOUT, &with(|t| 0.2 * t / 3600.0 / 2f64.sqrt())), 0.2, "slope_readout");
        shows(&row(&QUANTIZATION_READOUT, &with(|t| 5.0 * 3f64.sqrt() / t)), 5.0, "slope_readout");
    }

    #[test]
    fn what_other_terms_put_into_a_reading_is_told() {
        let mut gyro = with(white);
        let k = 0.5;
        gyro.identification.described.model = NoiseModel { n: N, k, ..Default::default() }.into();
        // N²·3600/τ of that and K²τ/10800, its root over the ten octaves.
        let share = |t: f64| {
            let own = 3600.0 * N * N / t;
            (own / (own + k * k * t / 10_800.0)).sqrt()
        };
        let own = (0..10).map(|i| share(0.5 * 2f64.powi(i))).sum::<f64>() / 10.0;
        assert!((0.2..0.9).contains(&own), "{own}");
        let found = row(&ANGLE_RANDOM_WALK_READOUT, &gyro);
        shows(&found, N, "slope_readout");
        within(number(&found, "readout.others", "percent"), 100.0 * (1.0 - own), 1e-9);
        let plain = Spread::ChiSquare {
            dof: {
                let bare = row(&ANGLE_RANDOM_WALK_READOUT, &with(white));
                chi_square(&bare)
            },
        };
        let points = curve(&found);
        assert_eq!(points.len(), 81);
        for (at, z, part) in [(0, -4.0, own), (30, -1.0, own), (40, 0.0, 1.0), (80, 4.0, 1.0)] {
            assert!((points[at].0 - z).abs() < 1e-9);
            within(points[at].1, part * plain.bound(N, normal_probability(z)).unwrap(), 1e-9);
        }
    }

    #[test]
    fn a_process_that_is_white_on_the_line_belongs_to_n_and_to_nothing_else() {
        let process = Damped { rms_deg_h: 0.3, frequency_hz: 0.0, decay_time_s: 0.05 };
        let terms = NoiseModel { n: N, k: 0.5, ..Default::default() };
        let model =
            Composite { markov: vec![process], ..Composite::from(NoiseModel { n: N, ..Default::default() }) };
        let mut gyro = with(|t| 0.3 * (t / 10_800.0).sqrt());
        gyro.identification.plateau = Plateau::of(&model, 0.5, 5000.0);
        assert!(gyro.identification.plateau.is_some());
        let taus: Vec<f64> = gyro.octaves.iter().map(|p| 0.5 * p.point.m as f64).collect();
        gyro.identification.described.model = model;
        near(own_part(&gyro, NoiseType::AngleRandomWalk, taus.iter()), 1.0);
        gyro.identification.described.model = terms.into();
        let share = |t: f64| {
            let own = 0.25 * t / 10_800.0;
            (own / (own + 3600.0 * N * N / t)).sqrt()
        };
        let expected = taus.iter().map(|t| share(*t)).sum::<f64>() / 10.0;
        within(own_part(&gyro, NoiseType::RateRandomWalk, taus.iter()), expected, 1e-9);
    }
}
