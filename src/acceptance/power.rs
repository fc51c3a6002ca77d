//! What a test can decide: for every limit the probability that a unit 1.5 times over it would be failed and that one
//! at half of it would be passed. Asked with the noise that was found (report) or with the typical noise of the family
//! (validation of a procedure, no data).

use crate::config::procedure::EffectiveLimits;
use crate::config::procedure::power::{LengthQuestion, PowerQuestion, Size, TypicalNoise};
use crate::estimate::{Dependence, Limit};
use crate::i18n::{Arg, Note, note};
use crate::measurand::{GyroEvidence, Measurand, PowerModel};
use crate::noise::expected::{
    Power, bias_power, decision_power, deviation_power, resolving_duration, term_variance,
};
use crate::noise::model::NoiseModel;
use crate::noise::static_bias::BiasUncertainty;
use crate::noise::windows::edf_of_window_std;
use crate::record::PowerRecord;

/// The situation a limit is to be decided in.
#[derive(Debug, Clone, Copy)]
pub struct Situation {
    /// Noise of the unit apart from the term in question.
    pub background: NoiseModel,
    /// Usable time, s.
    pub duration_s: f64,
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Standard uncertainty of the Earth rate on the axis, deg/h.
    pub earth_uncertainty_deg_h: f64,
}

/// Power of the limit on a measurand; `None` for measurands whose power is not a question of statistics here.
pub fn of_limit(measurand: &Measurand, limit: &Limit, situation: &Situation) -> Option<Power> {
    let max = limit.max.filter(|m| *m > 0.0)?;
    let s = situation;
    let samples = (s.duration_s / s.tau0_s).floor() as u64;
    let hours = s.duration_s / 3600.0;
    match measurand.power? {
        PowerModel::NoiseTerm(term) => {
            let background = s.background.with(term, 0.0);
            decision_power(term, max, &background, samples, s.tau0_s, limit.risk)
        }
        PowerModel::WindowMeans { window_s } => {
            let mut model = s.background;
            model.r = 0.0;
            let edf = |h: f64| {
                let n = (h * 3600.0 / window_s).floor() as u64;
                edf_of_window_std(n, window_s, |t| model.mean_variance(t)).unwrap_or(1.0)
            };
            Some(deviation_power(edf, hours, limit.risk))
        }
        PowerModel::Mean => {
            let uncertainty = |h: f64| {
                let others = [("earth_rate", s.earth_uncertainty_deg_h)];
                BiasUncertainty::of_mean(&s.background.into(), h * 3600.0, None, &others).standard()
            };
            Some(bias_power(max, uncertainty, hours, limit.risk))
        }
    }
}

/// The situation that a channel was found in.
pub fn situation(gyro: &GyroEvidence) -> Situation {
    Situation {
        background: gyro.identification.supported,
        duration_s: gyro.usable_s(),
        tau0_s: gyro.tau0_s,
        earth_uncertainty_deg_h: gyro.earth.map_or(0.0, |e| e.uncertainty_deg_h),
    }
}

/// Share of the variance of a mean that correlated noise has where the gains of its information still count as independent.
const INDEPENDENT_SHARE: f64 = 0.01;

/// Predicted variances of the estimate of a quantity at its limit in records of several lengths, up to a common factor, and how the
/// estimates hang together; `None` for quantities whose variance nothing predicts.
pub fn variances(
    measurand: &Measurand,
    limit: &Limit,
    situation: &Situation,
    lengths_s: &[f64],
) -> Option<(Vec<f64>, Dependence)> {
    let s = situation;
    let samples = |length_s: f64| (length_s / s.tau0_s).floor() as u64;
    match measurand.power? {
        PowerModel::NoiseTerm(term) => {
            let value = limit.largest_magnitude().filter(|v| *v > 0.0)?;
            let background = s.background.with(term, 0.0);
            let at = |length_s: &f64| term_variance(term, value, &background, samples(*length_s), s.tau0_s);
            Some((lengths_s.iter().map(at).collect::<Option<_>>()?, Dependence::IndependentGains))
        }
        PowerModel::WindowMeans { window_s } => {
            let mut model = s.background;
            model.r = 0.0;
            let at = |length_s: &f64| {
                let windows = (length_s / window_s).floor() as u64;
                Some(1.0 / edf_of_window_std(windows, window_s, |t| model.mean_variance(t))?)
            };
            Some((lengths_s.iter().map(at).collect::<Option<_>>()?, Dependence::IndependentGains))
        }
        PowerModel::Mean => {
            let others = [("earth_rate", s.earth_uncertainty_deg_h)];
            let of = |length_s: f64| BiasUncertainty::of_mean(&s.background.into(), length_s, None, &others);
            let full = of(*lengths_s.last()?);
            // The mean of white noise and a constant error gain independently; the mean of flicker or of a random walk does not.
            let correlated = full.flicker + full.rate_random_walk + full.rate_ramp;
            let is_white = correlated <= INDEPENDENT_SHARE * full.variance();
            let dependence = if is_white { Dependence::IndependentGains } else { Dependence::Unknown };
            Some((lengths_s.iter().map(|l| of(*l).variance()).collect(), dependence))
        }
    }
}

/// The power rows of a report, one for each limit and channel.
pub fn records(limits: &EffectiveLimits, gyros: &[GyroEvidence]) -> Vec<PowerRecord> {
    let mut rows = Vec::new();
    for spec in &limits.set.limits {
        for gyro in gyros {
            if limits.limit(spec.measurand.id, &gyro.channel) != Some(spec) {
                continue;
            }
            let Some(power) = of_limit(spec.measurand, &spec.limit, &situation(gyro)) else { continue };
            let Some(limit) = spec.limit.max else { continue };
            rows.push(PowerRecord {
                id: spec.measurand.id.to_owned(),
                channel: gyro.channel.clone(),
                limit,
                unit: spec.measurand.unit.to_owned(),
                power: power.fail_probability_at_1_5,
                pass_probability: power.pass_probability_at_half,
                needed_h: power.needed_duration_h.filter(|_| !power.is_enough()),
                message: message(&power, gyro.usable_s() / 3600.0).into(),
            });
        }
    }
    rows
}

fn message(power: &Power, hours: f64) -> Note {
    if power.is_enough() {
        return note!("power.enough", hours);
    }
    match power.needed_duration_h {
        Some(needed) => note!("power.too_short", hours, needed_h = needed),
        None => note!("power.never", hours),
    }
}

/// The warning of a procedure's limit that a record of its least length cannot decide, with what to do.
pub fn warning(question: &PowerQuestion) -> Option<(Note, Option<Note>)> {
    let background = background(&question.typical)?;
    let situation = Situation {
        background,
        duration_s: question.duration_s,
        // An open sample rate: one output a second is what static records of this kind have at least.
        tau0_s: question.sample_rate_hz.map_or(1.0, |hz| 1.0 / hz),
        earth_uncertainty_deg_h: 0.0,
    };
    let limit = &question.limit;
    let power = of_limit(limit.measurand, &limit.limit, &situation)?;
    if power.is_enough() {
        return None;
    }
    let max = limit.limit.max?;
    let hours = question.duration_s / 3600.0;
    let key = match question.sample_rate_hz {
        Some(_) => "check.power.undecided",
        None => "check.power.undecided_at_1_hz",
    };
    let message = Note::new(key)
        .with("hours", Arg::Stated(hours))
        .with("limit", format!("{} <= {max} {}", limit.measurand.id, limit.measurand.unit))
        .with("noise", Arg::Stated(background.n))
        .with("fail", Arg::fixed(power.fail_probability_at_1_5, 2))
        .with("pass", Arg::fixed(power.pass_probability_at_half, 2));
    let help = match power.needed_duration_h {
        Some(h) => note!("check.power.needed", hours = Arg::figures(h, HOUR_DIGITS)),
        None => note!("check.power.never"),
    };
    Some((message, Some(help)))
}

/// Digits of hours that are computed to a twentieth.
const HOUR_DIGITS: usize = 2;

/// How long a record must be for a slow term: for its limit to be decided, or for its typical size to be resolved.
pub fn length(question: &LengthQuestion) -> Option<Note> {
    let measurand = question.measurand;
    let name = |value: f64, sign: &str| format!("{} {sign} {value} {}", measurand.id, measurand.unit);
    let Some(background) = background(&question.typical) else {
        let Size::Limit(limit) = &question.size else { return None };
        return Some(note!("check.length.no_noise", term = name(limit.max?, "<=")));
    };
    let PowerModel::NoiseTerm(term) = measurand.power? else { return None };
    let tau0_s = question.sample_interval_s();
    let (key, hours, named) = match &question.size {
        Size::Limit(limit) => {
            // The search begins at any length that can be analysed.
            let duration_s = question.planned_s.unwrap_or(3600.0).max(100.0 * tau0_s);
            let situation = Situation { background, duration_s, tau0_s, earth_uncertainty_deg_h: 0.0 };
            let power = of_limit(measurand, limit, &situation)?;
            ("check.length.decided", power.needed_duration_h, name(limit.max?, "<="))
        }
        Size::Typical(value) => {
            let others = background.with(term, 0.0);
            ("check.length.resolved", resolving_duration(term, *value, &others, tau0_s), name(*value, "="))
        }
    };
    let hours: Arg = match hours {
        Some(hours) => note!("check.length.hours", hours = Arg::figures(hours, HOUR_DIGITS)).into(),
        None => note!("check.length.beyond").into(),
    };
    let samples = match question.sample_rate_hz {
        Some(rate) => note!("check.length.samples", rate = Arg::Stated(rate)),
        None => note!("check.length.samples_assumed"),
    };
    let planned = question.planned_s.map(|s| note!("check.length.planned", hours = Arg::Stated(s / 3600.0)));
    let note =
        Note::new(key).with("term", named).with("hours", hours).with("noise", Arg::Stated(background.n));
    let note = note.with("samples", samples);
    Some(match planned {
        Some(planned) => note!("check.length.of_planned", what = note, planned),
        None => note,
    })
}

/// The typical noise of a family; `None` when even the angle random walk is not stated.
fn background(typical: &TypicalNoise) -> Option<NoiseModel> {
    Some(NoiseModel {
        n: typical.angle_random_walk?,
        b: typical.bias_instability.unwrap_or(0.0),
        k: typical.rate_random_walk.unwrap_or(0.0),
        r: typical.rate_ramp.unwrap_or(0.0),
        q: typical.quantization.unwrap_or(0.0),
    })
}
