//! A plan made, carried out with each explanation as the truth, and explained.

use super::ambiguous::Ambiguous;
use super::physics::{Bench, Truth};
use crate::bench::EARTH;
use crate::bench::noise_source::NoiseSource;
use rayon::prelude::*;
use sagnac::claim::Claim;
use sagnac::config::{alternatives, model};
use sagnac::effect::Column;
use sagnac::mismatch::finding::{Explanation, MismatchVerdict};
use sagnac::mismatch::{Options, explain};
use sagnac::plan::{Limits, Plan, plan};
use sagnac::schedule::Schedule;
use sagnac::series::Series;

/// N, B and K of the gyro, as every model claims them.
const NOISE: [f64; 3] = [0.002, 0.001, 0.0005];
/// Noise of the thermometer, °C.
const THERMOMETER_DEGC: f64 = 0.005;
/// deg/h in 1 deg/s.
const PER_DEG_S: f64 = 3600.0;

/// A planned test carried out.
pub struct Carried {
    /// Length of the schedule, h.
    pub hours: f64,
    /// For each explanation as the truth.
    pub truths: Vec<Told>,
}

/// What explanations of the planned test said.
pub struct Told {
    /// The explanation that is true.
    pub kind: String,
    /// Probability, as the plan states it, that it is named alone.
    pub stated: f64,
    /// Records in which it was the only effect, and none of the others that were planned for an equivalent.
    pub decided: u64,
    /// Records in which it had no equivalent at all.
    pub alone: u64,
    /// Records in which it was named, with or without others.
    pub named: u64,
}

/// Plans a test, and carries it out so many times with each explanation as the truth; `None` where no schedule was found.
pub fn carried_out(ambiguous: &Ambiguous, records: u64, seed: u64) -> Option<Carried> {
    let claim = model::parse("model.toml", ambiguous.model.as_bytes()).ok()?.claim;
    let alternatives = alternatives::parse("alternatives.toml", ambiguous.alternatives.as_bytes()).ok()?;
    let limits = Limits::usual(3600.0 * ambiguous.budget_h);
    let Plan { schedule, causes, .. } = plan(&claim, &alternatives, &limits, &mut |_, _| {});
    let planned = schedule?;
    let planned_for = &causes.first()?.alternatives;
    let told = |(i, (truth, planned_for)): (usize, (&Truth, &sagnac::plan::record::AlternativePlan))| {
        let expected = planned_for.shows_as.as_deref();
        let others = causes.iter().flat_map(|c| &c.alternatives).filter_map(|a| a.shows_as.as_deref());
        let rivals: Vec<&str> = others.filter(|kind| Some(*kind) != expected).collect();
        let of = |record: u64| {
            let seed = 1_000_003 * seed + 10_007 * i as u64 + record;
            let series = recorded(*truth, &planned.schedule, &claim, seed);
            let outcome = explain(series, &claim, &Options::default(), &mut |_| {}).ok()?;
            Some(Said::new(&outcome.explanation, expected, &rivals))
        };
        let said: Vec<Said> = (0..records).into_par_iter().filter_map(of).collect();
        let count = |is: fn(&Said) -> bool| said.iter().filter(|s| is(s)).count() as u64;
        Told {
            kind: planned_for.kind.clone(),
            stated: planned_for.probability,
            decided: count(|s| s.decided),
            alone: count(|s| s.alone),
            named: count(|s| s.named),
        }
    };
    let truths = ambiguous.truths.iter().zip(planned_for).enumerate().map(told).collect();
    Some(Carried { hours: planned.duration_h, truths })
}

/// What one explanation said.
struct Said {
    decided: bool,
    alone: bool,
    named: bool,
}

impl Said {
    /// `expected` is what the record shows if the truth is true, `rivals` what it would show of the others.
    fn new(explanation: &Explanation, expected: Option<&str>, rivals: &[&str]) -> Said {
        let Some(kind) = expected else {
            let consistent = explanation.verdict == MismatchVerdict::Consistent;
            return Said { decided: consistent, alone: consistent, named: consistent };
        };
        let only = match &explanation.effects[..] {
            [only] if only.kind == kind => Some(&only.equivalents),
            _ => None,
        };
        Said {
            decided: only
                .is_some_and(|equivalents| !equivalents.iter().any(|e| rivals.contains(&e.as_str()))),
            alone: only.is_some_and(Vec::is_empty),
            named: explanation.effects.iter().any(|f| f.kind == kind),
        }
    }
}

/// The recording of a schedule by a gyro with a truth.
fn recorded(truth: Truth, schedule: &Schedule, claim: &Claim, seed: u64) -> Series {
    let dt_s = 1.0 / claim.sample_rate_hz;
    let samples = (schedule.duration_s() / dt_s).round() as usize;
    let mut noise = NoiseSource::new(seed);
    let mut bench = Bench { dt_s, samples, temperature: None, table_rate: None, table_angle: None };
    for profile in schedule.profiles(0.0, |_| 0.0) {
        let values = Some((0..samples).map(|i| profile.at(i as f64 * dt_s)).collect::<Vec<f64>>());
        match profile.column {
            Column::Temperature => bench.temperature = values,
            Column::TableRate => bench.table_rate = values,
            _ => bench.table_angle = values,
        }
    }
    let added = truth.adds(&bench, &mut noise);
    let [n, b, k] = NOISE;
    let white = noise.white(n, dt_s, samples);
    let flicker = noise.flicker(b, dt_s, samples);
    // A walk that is larger than claimed stands in the place of the claimed one.
    let walk = match truth {
        Truth::Walk { .. } => vec![0.0; samples],
        _ => noise.walk(k, dt_s, samples),
    };
    let mean = expected(&bench, claim);
    let rate = (0..samples).map(|i| mean[i] + added[i] + white[i] + flicker[i] + walk[i]).collect();
    let mut columns = std::collections::BTreeMap::new();
    if let Some(t) = &bench.temperature {
        let seen = t.iter().map(|t| t + THERMOMETER_DEGC * noise.normal()).collect();
        columns.insert(Column::Temperature, seen);
    }
    columns.extend(bench.table_rate.map(|r| (Column::TableRate, r)));
    columns.extend(bench.table_angle.map(|a| (Column::TableAngle, a)));
    Series {
        time_s: (0..samples).map(|i| i as f64 * dt_s).collect(),
        rate_deg_h: rate,
        columns,
        index: (0..samples as u64).collect(),
        sample_interval_s: dt_s,
        ..Series::default()
    }
}

/// What the claim expects of each sample, deg/h.
fn expected(bench: &Bench, claim: &Claim) -> Vec<f64> {
    let at = |i: usize| {
        let mut mean = claim.mean.bias_deg_h;
        if let (Some(t), Some(temperature)) = (&bench.temperature, claim.mean.temperature) {
            mean += temperature.coefficient_deg_h_per_degc * (t[i] - temperature.reference_degc);
        }
        if let Some(rate) = &bench.table_rate {
            mean += PER_DEG_S * (1.0 + 1e-6 * claim.mean.scale_factor_ppm.unwrap_or(0.0)) * rate[i];
        }
        if let (Some(angle), Some(earth)) = (&bench.table_angle, claim.mean.earth) {
            let horizontal = EARTH * earth.latitude_deg.to_radians().cos();
            mean += horizontal * (angle[i] + earth.azimuth_deg).to_radians().cos();
        }
        mean
    };
    (0..bench.samples).map(at).collect()
}
