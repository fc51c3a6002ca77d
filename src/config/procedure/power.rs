//! Decisions that a procedure can make, asked before there are data.
//!
//! Each limit on noise becomes a question: with this record length and this typical noise, would a unit over the
//! limit be failed, and one well inside be passed? The answer comes from the statistics of the estimators, which
//! know no procedure; this file only puts the question and places the answer in the text.

use super::diagnostics::{Problem, SourceText};
use super::limits::{EffectiveLimits, LimitSet, LimitSpec, LimitsFile};
use super::model::{Loaded, Procedure};
use crate::estimate::Limit;
use crate::i18n::Note;
use crate::measurand::{self, Measurand, PowerModel};
use crate::noise::data::NoiseType;
use std::ops::Range;

/// Typical noise of a family, in inside units. `None`: not stated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TypicalNoise {
    /// N, deg/sqrt(h).
    pub angle_random_walk: Option<f64>,
    /// B, deg/h.
    pub bias_instability: Option<f64>,
    /// K, deg/h/sqrt(h).
    pub rate_random_walk: Option<f64>,
    /// R, deg/h/h.
    pub rate_ramp: Option<f64>,
    /// Q, arcsec.
    pub quantization: Option<f64>,
}

/// A limit and the record it is to be decided with.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerQuestion {
    /// The limit.
    pub limit: LimitSpec,
    /// Channels it holds for.
    pub channels: Vec<String>,
    /// Usable time of a record as planned, else the least of a valid one, s.
    pub duration_s: f64,
    /// Declared sample rate, Hz; `None` where the procedure leaves it open.
    pub sample_rate_hz: Option<f64>,
    /// Typical noise of the family.
    pub typical: TypicalNoise,
}

/// The typical noise of the family, as the limits state it.
pub fn typical_noise(effective: &EffectiveLimits) -> TypicalNoise {
    TypicalNoise {
        angle_random_walk: effective.expected(measurand::ANGLE_RANDOM_WALK.id),
        bias_instability: effective.expected(measurand::BIAS_INSTABILITY.id),
        rate_random_walk: effective.expected(measurand::RATE_RANDOM_WALK.id),
        rate_ramp: effective.expected(measurand::RATE_RAMP.id),
        quantization: effective.expected(measurand::QUANTIZATION.id),
    }
}

/// The questions of a procedure with its limits; none when it states neither a planned nor a least duration.
pub fn questions(procedure: &Procedure, effective: &EffectiveLimits) -> Vec<PowerQuestion> {
    let conditions = &procedure.conditions;
    let Some(duration_s) = conditions.planned_duration_s.or(conditions.minimum_duration_s) else {
        return vec![];
    };
    let typical = typical_noise(effective);
    let gyro: Vec<&str> = procedure.gyro_channels().map(|c| c.channel.id.as_str()).collect();
    let mut list = vec![];
    for limit in &effective.set.limits {
        let id = limit.measurand.id;
        // A channel with a limit of its own is not judged by the limit for every channel.
        let holds = |channel: &str| {
            procedure.measures(id, Some(channel)) && effective.limit(id, channel).is_some_and(|l| l == limit)
        };
        let channels: Vec<String> = gyro.iter().filter(|c| holds(c)).map(|c| (*c).to_owned()).collect();
        if !channels.is_empty() {
            let sample_rate_hz = procedure.sample_rate_hz;
            list.push(PowerQuestion { limit: limit.clone(), channels, duration_s, sample_rate_hz, typical });
        }
    }
    list
}

/// The size of a slow term for which the length of a record is asked.
#[derive(Debug, Clone, PartialEq)]
pub enum Size {
    /// A limit that is to be decided.
    Limit(Limit),
    /// The typical size, which is to be resolved.
    Typical(f64),
}

/// How long a record must be for a slow term, B or K.
#[derive(Debug, Clone, PartialEq)]
pub struct LengthQuestion {
    /// The term.
    pub measurand: &'static Measurand,
    /// What is to be decided or resolved.
    pub size: Size,
    /// Typical noise of the family.
    pub typical: TypicalNoise,
    /// Usable time of a record as planned, else the least of a valid one, s.
    pub planned_s: Option<f64>,
    /// Declared sample rate, Hz; `None` where it is left open.
    pub sample_rate_hz: Option<f64>,
}

impl LengthQuestion {
    /// Interval of the samples, s: where it is left open, one second.
    pub fn sample_interval_s(&self) -> f64 {
        self.sample_rate_hz.map_or(1.0, |hz| 1.0 / hz)
    }
}

/// The lengths that limits and typical values ask for, each once; `procedure` is the test that they are for.
pub fn lengths(set: &LimitSet, procedure: Option<&Procedure>) -> Vec<LengthQuestion> {
    let slow = |m: &Measurand| {
        let terms = [NoiseType::Flicker, NoiseType::RateRandomWalk];
        terms.iter().any(|term| m.power == Some(PowerModel::NoiseTerm(*term)))
            && procedure.is_none_or(|p| p.measures(m.id, None))
    };
    let limits = EffectiveLimits { set: set.clone(), ..EffectiveLimits::default() };
    let typical = typical_noise(&limits);
    let conditions = procedure.map(|p| &p.conditions);
    let planned_s = conditions.and_then(|c| c.planned_duration_s.or(c.minimum_duration_s));
    let sample_rate_hz = procedure.and_then(|p| p.sample_rate_hz);
    let question = |measurand, size| LengthQuestion { measurand, size, typical, planned_s, sample_rate_hz };
    let limited = set.limits.iter().filter(|l| slow(l.measurand));
    let limited = limited.map(|l| question(l.measurand, Size::Limit(l.limit.clone())));
    let stated = set.expected.iter().filter(|e| slow(e.measurand) && e.value > 0.0);
    let stated = stated.map(|e| question(e.measurand, Size::Typical(e.value)));
    let mut list: Vec<LengthQuestion> = vec![];
    for question in limited.chain(stated) {
        if !list.contains(&question) {
            list.push(question);
        }
    }
    list
}

/// Turns answers into warnings at the place of each limit.
///
/// `answer` gives the sentence and what to do, or `None` when the limit can be decided.
pub fn warnings(
    questions: &[PowerQuestion],
    procedure: &Loaded<Procedure>,
    limits: Option<&Loaded<LimitsFile>>,
    mut answer: impl FnMut(&PowerQuestion) -> Option<(Note, Option<Note>)>,
) -> Vec<Problem> {
    let source_of = |name: &str| -> &SourceText {
        match limits {
            Some(file) if file.source.name == name => &file.source,
            _ => &procedure.source,
        }
    };
    let mut found = vec![];
    for question in questions {
        if let Some((message, help)) = answer(question) {
            let span: &Range<usize> = &question.limit.span;
            let mut problem = source_of(&question.limit.limit.source).warning(span, message);
            problem.help = help;
            found.push(problem);
        }
    }
    found
}
