//! Effects on single samples as findings: bursts, a level that changes, jumps between two levels.

use super::estimates::Estimated;
use super::finding::ParameterValue;
use super::improvement::Improvement;
use super::local::{Bursts, Law, Level, Telegraph};
use super::problem::Problem;
use super::quantization_grid::QuantizationGrid;
use super::regular::Grid;
use super::repeats::Repeats;
use super::select::ENOUGH;
use super::tried::Tried;
use crate::effect::{Domain, Effect, Place, Value, find};
use std::collections::BTreeMap;

/// An effect that was named, however it was found.
pub struct Named {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Parameters.
    pub estimated: Estimated,
    /// Kinds that would have served as well.
    pub equivalents: Vec<&'static str>,
    /// Where, principal first.
    pub places: Vec<Place>,
    /// BIC without it less BIC with it.
    pub delta_bic: f64,
    /// Probability without it, everything counted.
    pub p_value: f64,
    /// What it improves, where the fit in cosine modes tells.
    pub improvement: Option<Improvement>,
    /// Gain of log-likelihood that the fit in cosine modes does not hold.
    pub local_gain: f64,
}

/// Whether a gain is worth its parameters and is no chance. `family` counts the catalogue.
pub fn worth(gain: f64, parameters: usize, p_value: f64, rows: usize, alpha: f64) -> Option<f64> {
    const FAMILY: f64 = 40.0;
    let delta_bic = 2.0 * gain - parameters as f64 * (rows as f64).ln();
    (delta_bic >= ENOUGH && FAMILY * p_value < alpha).then_some(delta_bic)
}

fn value(value: f64, unit: &str, ci95: [f64; 2]) -> ParameterValue {
    ParameterValue { value, unit: unit.to_owned(), ci95 }
}

/// Rounding in steps that the values themselves show, as a finding.
pub fn quantization(
    quantization_grid: QuantizationGrid,
    gain: f64,
    delta_bic: f64,
    p_value: f64,
    problem: &Problem,
) -> Option<Named> {
    let (lsb_arcsec, open) = (quantization_grid.increment_arcsec, quantization_grid.open_arcsec);
    let ci95 = [lsb_arcsec - open, lsb_arcsec + open];
    let step = lsb_arcsec / problem.grid.dt_s;
    // Successive errors of the angle are subtracted: twice the variance of a rounding error.
    let rms = step / 6f64.sqrt();
    let reported = BTreeMap::from([
        ("lsb_arcsec".to_owned(), value(lsb_arcsec, "arcsec", ci95)),
        ("rms_deg_h".to_owned(), value(rms, "deg/h", [rms * 0.999, rms * 1.001])),
    ]);
    Some(Named {
        effect: find("quantization")?,
        estimated: Estimated {
            reported,
            stated: BTreeMap::from([("lsb_arcsec".to_owned(), Value::Number(lsb_arcsec))]),
        },
        equivalents: vec![],
        places: vec![Place { domain: Domain::Amplitude, from: 0.0, to: step }],
        delta_bic,
        p_value,
        improvement: None,
        local_gain: gain,
    })
}

/// Bursts as a finding.
pub fn bursts(found: &Bursts, delta_bic: f64, removed: &[f64], problem: &Problem) -> Option<Named> {
    let drivers = &problem.drivers;
    let count = found.groups.len() as f64;
    let n = removed.len().max(1) as f64;
    let mean = removed.iter().sum::<f64>() / n;
    let rms = (removed.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / n).sqrt();
    let spread = 1.96 / (2.0 * found.samples.len().max(1) as f64).sqrt();
    let mut reported = BTreeMap::new();
    reported.insert("count".to_owned(), value(count, "", [count, count + found.missed as f64]));
    reported.insert("rms_deg_h".to_owned(), value(rms, "deg/h", [rms * (-spread).exp(), rms * spread.exp()]));
    let size = |g: &(usize, usize)| {
        let inside = &removed[g.0..g.0 + g.1];
        (inside.iter().map(|r| r * r).sum::<f64>() / inside.len().max(1) as f64).sqrt()
    };
    let list = |f: &dyn Fn(&(usize, usize)) -> f64| Value::List(found.groups.iter().map(f).collect());
    let stated = BTreeMap::from([
        ("count".to_owned(), Value::Number(count)),
        ("bursts_time_s".to_owned(), list(&|g| drivers.time_s(g.0))),
        ("bursts_duration_s".to_owned(), list(&|g| g.1 as f64 * drivers.dt_s)),
        ("bursts_size_deg_h".to_owned(), list(&size)),
    ]);
    let (first, last) = (found.groups.first()?, found.groups.last()?);
    let mut places = vec![Place {
        domain: Domain::Time,
        from: drivers.time_s(first.0) - drivers.dt_s,
        to: drivers.time_s(last.0 + last.1),
    }];
    let largest = found.samples.iter().map(|i| removed[*i].abs()).fold(0.0, f64::max);
    places.push(Place { domain: Domain::Amplitude, from: 0.3 * largest, to: largest });
    Some(Named {
        effect: find("outlier_bursts")?,
        estimated: Estimated { reported, stated },
        equivalents: vec![],
        places,
        delta_bic,
        p_value: found.p_value,
        improvement: None,
        local_gain: found.gain,
    })
}

/// Samples that repeat the one before them as a finding.
pub fn repeats(found: &Repeats, delta_bic: f64, grid: &Grid) -> Option<Named> {
    /// Runs that a claim lists one by one.
    const LISTED: usize = 256;
    let runs = found.runs();
    let (k, n) = (found.rows.len() as f64, found.of.max(1) as f64);
    let share = k / n;
    let each = k / runs.len().max(1) as f64;
    // Rows of one run repeat together.
    let half = 1.96 * (share * (1.0 - share) * each / n).sqrt();
    let ci95 = [(share - half).max(0.0), (share + half).min(1.0)];
    let time_s = |row: usize| grid.start_s + row as f64 * grid.dt_s;
    let mut stated = BTreeMap::from([
        ("repeated_share".to_owned(), Value::Number(share)),
        ("repeated_rows_each".to_owned(), Value::Number(each)),
    ]);
    if runs.len() <= LISTED {
        let times = runs.iter().map(|r| time_s(r.0)).collect();
        stated.insert("repeats_time_s".to_owned(), Value::List(times));
        stated.insert("repeats_rows".to_owned(), Value::List(runs.iter().map(|r| r.1 as f64).collect()));
    }
    let (first, last) = found.stretch()?;
    Some(Named {
        effect: find("repeated_samples")?,
        estimated: Estimated {
            reported: BTreeMap::from([("repeated_share".to_owned(), value(share, "", ci95))]),
            stated,
        },
        equivalents: vec![],
        places: vec![Place { domain: Domain::Time, from: time_s(first - 1), to: time_s(last) }],
        delta_bic,
        p_value: found.chance,
        improvement: None,
        local_gain: found.gain,
    })
}

/// A level that changes as a finding. The second best law of another kind is its equivalent when it is near.
pub fn level(found: &[Level], delta_bic: f64, rows: usize, problem: &Problem) -> Option<Named> {
    let best = found.first()?;
    let score = |l: &Level| 2.0 * l.gain - l.parameters as f64 * (rows as f64).ln();
    let equivalents = found
        .iter()
        .skip(1)
        .filter(|l| l.kind != best.kind && score(l) > score(best) - ENOUGH)
        .map(|l| l.kind)
        .take(1)
        .collect();
    let reported = BTreeMap::from([("ratio".to_owned(), value(best.ratio, "", best.ci95))]);
    let mut stated = BTreeMap::from([("ratio".to_owned(), Value::Number(best.ratio))]);
    if let Law::Rate { exponent, .. } = &best.law {
        stated.insert("exponent".to_owned(), Value::Number(f64::from(*exponent)));
    }
    if best.kind == "noise_variance_time" {
        let knots = match &best.law {
            Law::Time(knots) => knots.clone(),
            _ => profile_knots(&best.profile, problem),
        };
        stated.insert("knots_time_s".to_owned(), Value::List(knots.iter().map(|k| k.0).collect()));
        stated.insert("knots_ratio".to_owned(), Value::List(knots.iter().map(|k| k.1).collect()));
    }
    Some(Named {
        effect: find(best.kind)?,
        estimated: Estimated { reported, stated },
        equivalents,
        places: best.places.clone(),
        delta_bic,
        p_value: best.p_value,
        improvement: None,
        local_gain: best.gain,
    })
}

/// A profile over time at some hundred knots.
fn profile_knots(profile: &[f64], problem: &Problem) -> Vec<(f64, f64)> {
    let step = (profile.len() / 256).max(1);
    (0..profile.len()).step_by(step).map(|i| (problem.drivers.time_s(i), profile[i])).collect()
}

/// Jumps between two levels as a finding.
pub fn telegraph(found: &Telegraph, delta_bic: f64, problem: &Problem) -> Option<Named> {
    let n = found.path.len().max(1) as f64;
    let share = found.path.iter().map(|p| p * p).sum::<f64>() / n;
    let rms = found.amplitude_deg_h.abs() * share.sqrt();
    let [low, high] = found.amplitude_ci95.map(|a| a.abs() * share.sqrt());
    let reported = BTreeMap::from([
        ("amplitude_deg_h".to_owned(), value(found.amplitude_deg_h, "deg/h", found.amplitude_ci95)),
        ("mean_dwell_s".to_owned(), value(found.mean_dwell_s, "s", found.dwell_ci95)),
        ("rms_deg_h".to_owned(), value(rms, "deg/h", [low.min(high), low.max(high)])),
    ]);
    let stated = BTreeMap::from([
        ("amplitude_deg_h".to_owned(), Value::Number(found.amplitude_deg_h)),
        ("mean_dwell_s".to_owned(), Value::Number(found.mean_dwell_s)),
    ]);
    let jumps: Vec<usize> = (1..found.path.len()).filter(|i| found.path[*i] != found.path[*i - 1]).collect();
    let (first, last) = (*jumps.first()?, *jumps.last()?);
    let at = |i: usize| problem.drivers.time_s(i);
    Some(Named {
        effect: find("random_telegraph")?,
        estimated: Estimated { reported, stated },
        equivalents: vec![],
        places: vec![Place { domain: Domain::Time, from: at(first), to: at(last) }],
        delta_bic,
        p_value: found.p_value,
        improvement: None,
        local_gain: found.gain,
    })
}

/// The same hypothesis with N set free, for a level of the noise that is not the claimed one everywhere.
pub fn with_free_level(base: &Tried, problem: &Problem) -> Tried {
    let mut hypothesis = base.hypothesis.clone();
    hypothesis.noise.freed[0] = true;
    let fit = super::hypothesis::fit(&mut hypothesis, &problem.spectra.full);
    Tried { hypothesis, fit, parameters: base.parameters + 1, odds: base.odds }
}
