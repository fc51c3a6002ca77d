//! Whether N, B and K of a fit are what the Allan curve of the same record reads.
//!
//! A reading off the curve holds a part of every other term. So the curve is set against what the fitted description
//! predicts for it, at the averaging times where the term rules; what is left over is counted to the term. Where the two
//! differ by more than both intervals allow, neither decides.

use crate::estimate::{Estimate, Finding, Holds, Interval, Spread};
use crate::evidence::GyroEvidence;
use crate::message::note;
use crate::noise::composite::{Composite, Described};
use crate::noise::data::NoiseType;
use crate::noise::identification::Identification;
use crate::noise::intervals::BoundedPoint;
use crate::noise::model::unit_allan_variance;
use crate::noise::slope::{LARGEST_SHARE, SlopePoint, read, reading_time_s, runs, through};

/// Share of the variance that a term must have where it is read.
const DOMINANT_SHARE: f64 = 0.5;
/// Relative difference of two readings that says nothing: no model of a real output is better.
const HARMLESS_DIFFERENCE: f64 = 0.02;
/// Least degrees of freedom of a point that is read.
const MIN_EDF: f64 = 4.0;
/// Coverage of the intervals that are compared.
const INTERVAL_COVERAGE: f64 = 0.95;

/// A coefficient as the curve reads it, everything else taken out.
struct Reading {
    value: f64,
    interval: Interval,
    from_s: f64,
    to_s: f64,
}

/// The octaves of a record that are read.
struct Curve {
    observed: Vec<SlopePoint>,
}

impl Curve {
    fn of(octaves: &[BoundedPoint], tau0_s: f64, samples: u64, highest_hz: Option<f64>) -> Curve {
        // A model that holds up to a frequency says nothing of shorter averaging times.
        let shortest_s = highest_hz.map_or(0.0, |hz| 1.0 / hz);
        let observed = octaves
            .iter()
            .filter(|p| p.point.m as f64 <= LARGEST_SHARE * samples as f64)
            .map(|p| SlopePoint {
                tau_s: p.point.m as f64 * tau0_s,
                deviation: p.point.deviation,
                edf: p.edf,
            })
            .filter(|p| p.tau_s >= shortest_s && p.deviation > 0.0 && p.edf >= MIN_EDF)
            .collect();
        Curve { observed }
    }

    fn predicted(&self, model: &Composite, tau0_s: f64) -> Vec<SlopePoint> {
        let at = |p: &SlopePoint| {
            let variance = model.allan_variance(p.tau_s, tau0_s);
            SlopePoint { deviation: variance.max(f64::MIN_POSITIVE).sqrt(), ..*p }
        };
        self.observed.iter().map(at).collect()
    }
}

/// The coefficient of a claimed term as the curve reads it; `None` where it rules nowhere.
fn reading(
    curve: &Curve,
    described: &Described,
    term: NoiseType,
    parts: &Composite,
    coefficient: f64,
    tau0_s: f64,
) -> Option<Reading> {
    let predicted = curve.predicted(&described.model, tau0_s);
    let share = |p: &SlopePoint| parts.allan_variance(p.tau_s, tau0_s) / p.deviation.powi(2);
    let line = runs(&predicted, term)
        .into_iter()
        .filter(|r| {
            predicted.get(r.clone()).is_some_and(|line| line.iter().all(|p| share(p) >= DOMINANT_SHARE))
        })
        .max_by_key(|r| r.len())?;
    let (seen, expected) = (curve.observed.get(line.clone())?, predicted.get(line)?);
    let (seen_line, expected_line) = (through(seen, term)?, through(expected, term)?);
    let ratio = seen_line.value / expected_line.value;
    // The uncertainty of the prediction counts as well.
    let level = |model: &Composite| {
        seen.iter().map(|p| model.allan_variance(p.tau_s, tau0_s).max(f64::MIN_POSITIVE).ln()).sum::<f64>()
            / (2.0 * seen.len() as f64)
    };
    let known = described.propagate(level).standard_uncertainty;
    let dof = 0.5 / (0.5 / seen_line.dof + known * known);
    let bounds = Spread::ChiSquare { dof }.interval(ratio, INTERVAL_COVERAGE)?;
    let share = expected.iter().map(share).sum::<f64>() / expected.len() as f64;
    let of = |r: f64| coefficient * ((r * r - (1.0 - share)).max(0.0) / share).sqrt();
    Some(Reading {
        value: of(ratio),
        interval: Interval { low: of(bounds.low), high: of(bounds.high), coverage: INTERVAL_COVERAGE },
        from_s: seen_line.from_s,
        to_s: seen_line.to_s,
    })
}

/// What the curve reads of a term that the description lacks: the line of its slope, less what the description predicts.
fn unclaimed(curve: &Curve, described: &Described, term: NoiseType, tau0_s: f64) -> Option<Reading> {
    let line = read(&curve.observed, term)?;
    let on_line: Vec<SlopePoint> =
        curve.observed.iter().filter(|p| (line.from_s..=line.to_s).contains(&p.tau_s)).copied().collect();
    let beside = Curve { observed: on_line }.predicted(&described.model, tau0_s);
    let expected = through(&beside, term)?.value;
    // The ordinate at the reading time is the coefficient, times 0.664 for flicker.
    let unit = unit_allan_variance(term, reading_time_s(term)).sqrt();
    let of = |ordinate: f64| (ordinate.powi(2) - expected.powi(2)).max(0.0).sqrt() / unit;
    let bounds = Spread::ChiSquare { dof: line.dof }.interval(line.value, INTERVAL_COVERAGE)?;
    Some(Reading {
        value: of(line.value),
        interval: Interval { low: of(bounds.low), high: of(bounds.high), coverage: INTERVAL_COVERAGE },
        from_s: line.from_s,
        to_s: line.to_s,
    })
}

/// N, B and K against the Allan curve of the same record: a finding for each of which the 95 % intervals of fit and curve
/// exclude each other.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    findings(&gyro.identification, &gyro.octaves, gyro.tau0_s, gyro.digest.samples)
}

/// `octaves` are the overlapping Allan deviations at octaves of `tau0_s`, of a record of `samples` samples.
fn findings(found: &Identification, octaves: &[BoundedPoint], tau0_s: f64, samples: u64) -> Vec<Finding> {
    let curve = Curve::of(octaves, tau0_s, samples, found.highest_hz);
    let described = &found.described;
    let model = &described.model;
    let of = |term: NoiseType| {
        let white = term == NoiseType::AngleRandomWalk;
        let (parts, coefficient) = match found.plateau.as_ref().filter(|_| white) {
            Some(plateau) => (plateau.parts(model), plateau.level(model)),
            None => (model.alone(term), model.terms.coefficient(term)),
        };
        let estimate = match term {
            NoiseType::AngleRandomWalk => found.read_angle_random_walk(),
            NoiseType::Flicker => &found.bias_instability,
            _ => &found.rate_random_walk,
        };
        let read = match estimate.value {
            Some(_) => reading(&curve, described, term, &parts, coefficient, tau0_s),
            // White noise read beside a limit on it would have been claimed.
            None if white => None,
            None => unclaimed(&curve, described, term, tau0_s),
        };
        contradiction(estimate, &read?)
    };
    [NoiseType::AngleRandomWalk, NoiseType::Flicker, NoiseType::RateRandomWalk]
        .into_iter()
        .filter_map(of)
        .collect()
}

fn contradiction(estimate: &Estimate, read: &Reading) -> Option<Finding> {
    let Interval { low, high, .. } = read.interval;
    let fitted = estimate.interval95();
    let differs = match (fitted, estimate.upper_limit) {
        (Some(i), _) => {
            low * (1.0 - HARMLESS_DIFFERENCE) > i.high || high * (1.0 + HARMLESS_DIFFERENCE) < i.low
        }
        (None, Some(limit)) => low * (1.0 - HARMLESS_DIFFERENCE) > limit.value,
        (None, None) => false,
    };
    let note = match (estimate.value, fitted, estimate.upper_limit) {
        _ if !differs => return None,
        (Some(value), Some(i), _) => {
            note!("criticism_found.curve_disagrees", fitted = value, fitted_low = i.low, fitted_high = i.high)
        }
        (_, _, Some(limit)) => note!("criticism_found.curve_exceeds", limit = limit.value),
        _ => return None,
    };
    Some(Finding {
        measurands: vec![estimate.id],
        holds: Holds::Nothing,
        found: note
            .with("read", read.value)
            .with("low", low)
            .with("high", high)
            .with("from_s", read.from_s)
            .with("to_s", read.to_s),
        advice: note!("criticism_advice.allan_curve"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::composite::Parameter;
    use crate::noise::data::DeviationPoint;
    use crate::noise::model::NoiseModel;

    fn octaves(deviation: impl Fn(f64) -> f64) -> Vec<BoundedPoint> {
        let point = |k: u32| {
            let m = 1u64 << k;
            BoundedPoint {
                point: DeviationPoint { m, terms: 100_000 / m, stride: 1, deviation: deviation(m as f64) },
                noise: NoiseType::AngleRandomWalk,
                edf: 60_000.0 / m as f64,
                interval95: None,
                interval68: None,
            }
        };
        (0..14).map(point).collect()
    }

    fn fitted(n: f64, u: f64) -> Identification {
        let mut found = Identification::empty("rate");
        let spread = Spread::Normal { standard_uncertainty: u };
        found.angle_random_walk = Estimate::measured("angle_random_walk", "rate", n, "", spread, "whittle");
        found.described = Described {
            model: NoiseModel { n, ..Default::default() }.into(),
            parameters: vec![Parameter::Coefficient(NoiseType::AngleRandomWalk)],
            covariance: vec![vec![u * u]],
        };
        found
    }

    #[test]
    fn a_fit_that_the_curve_contradicts_decides_nothing() {
        let truth = NoiseModel { n: 0.0264, ..Default::default() };
        let curve = octaves(|tau_s| truth.allan_variance(tau_s).sqrt());
        for (n, contested) in [(0.0264, false), (0.0266, false), (0.0174, true)] {
            let findings = findings(&fitted(n, 0.005 * n), &curve, 1.0, 100_000);
            assert_eq!(findings.len(), usize::from(contested), "{n}");
            assert!(findings.iter().all(|f| f.measurands == ["angle_random_walk"]));
        }
    }

    #[test]
    fn what_other_terms_add_to_a_reading_is_no_contradiction() {
        // At σ of N and B alike the line reads too high, and the prediction does so as well.
        let truth = NoiseModel { n: 0.02, b: 0.05, ..Default::default() };
        let curve = octaves(|tau_s| truth.allan_variance(tau_s).sqrt());
        let mut found = fitted(0.02, 1e-4);
        found.described.model = truth.into();
        assert_eq!(findings(&found, &curve, 1.0, 100_000), []);
    }
}
