//! Flicker, random walk, ramp and long Markov processes beside the other parts of a model.

use super::super::claims::{B, K, R, SLOW_SET_COUNT, SlowChoice, SlowPrices, SlowSet};
use super::super::result::Identification;
use super::fit::Joint;
use super::model::{
    BASE_TERMS, Free, JointPoint, MAX_PROCESSES, MAX_TIME_SHARE, ProcessKind, Shape, Variable,
};
use crate::message::note;
use crate::noise::composite::Damped;

/// Fall of the deviance that fitting the correlation time brings over the grid of octaves at most.
const MAX_REFINEMENT: f64 = 5.0;
/// Excess below which a Markov process counts as describing the record about as well: its price above that of flicker.
const NEAR_EXCESS: f64 = 7.6;
/// Excess from which a Markov process is told from flicker: the record is then 4.5 times as likely with flicker.
const TOLD_EXCESS: f64 = NEAR_EXCESS + 3.0;
/// Shortest correlation time of a process that can stand for flicker or random walk, sample intervals.
const MIN_TIME_SAMPLES: f64 = 4.0;

/// The slow terms of one shape.
pub(super) struct Slow {
    /// The maximum with all of N, B, K and Q, without and with a ramp.
    pub level: JointPoint,
    pub sloped: JointPoint,
    /// Plain deviance of each set.
    pub deviance: [f64; SLOW_SET_COUNT],
    /// The set chosen.
    pub choice: SlowChoice,
    /// By how much the best set without each of N, B, K, Q and R costs more.
    pub preference: [f64; 5],
}

/// What a fit of one set may change.
fn free_of(shape: &Shape, set: SlowSet) -> Free {
    let mut free = Free::all(shape, set & R != 0, true);
    free.variance[1] = set & B != 0;
    free.variance[2] = set & K != 0;
    free
}

/// The maximum of a set from a start, with the plain deviance at the restricted estimate of the ramp: restricted
/// likelihoods of different structures are those of different data.
fn fitted(joint: &Joint<'_>, start: &JointPoint, set: SlowSet) -> JointPoint {
    let free = free_of(&start.shape, set);
    let mut start = start.clone();
    for (i, allowed) in free.variance.iter().enumerate() {
        if !allowed && let Some(v) = start.variance.get_mut(i) {
            *v = 0.0;
        }
    }
    let point = joint.maximise(&start, &free);
    if set & R == 0 {
        return point;
    }
    joint.maximise(&point, &Free { held: Some(Variable::Ramp), ..free })
}

impl Slow {
    /// Fits every set.
    pub fn of(joint: &Joint<'_>, shape: &Shape, prices: &SlowPrices) -> Option<Slow> {
        let level = joint.best(shape, false);
        let sloped = joint.best(shape, true);
        let mut deviance = [f64::INFINITY; SLOW_SET_COUNT];
        for (set, value) in deviance.iter_mut().enumerate() {
            let near = if set & R == 0 { &level } else { &sloped };
            *value = fitted(joint, near, set).deviance;
        }
        // A larger set is never worse: what says otherwise is a fit that stopped early.
        for set in 0..SLOW_SET_COUNT {
            for part in [B, K, R] {
                if set & part != 0 && deviance[set ^ part] < deviance[set] {
                    deviance[set] = deviance[set ^ part];
                }
            }
        }
        let choice = prices.choose(&deviance)?;
        let preference = std::array::from_fn(|term| prices.preference(&deviance, choice, term));
        Some(Slow { level, sloped, deviance, choice, preference })
    }

    /// Cost of the shape where its Markov process stands in the place of flicker and random walk.
    pub fn choice_without_rivals(&self, prices: &SlowPrices) -> f64 {
        let level = self.deviance[0] + prices.markov;
        level.min(self.deviance[R] + prices.markov_and_ramp)
    }
}

/// A Markov process in the place of flicker and random walk.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LongMarkov {
    /// The shape with it.
    pub shape: Shape,
    /// By how much it costs more than the slow terms that were chosen; negative where it is to be preferred.
    pub excess: f64,
    sigma: f64,
    time_s: f64,
}

impl LongMarkov {
    /// Keeps the process, and says so on the estimates of flicker and random walk where it describes the record about as well.
    pub fn annotate(&self, found: &mut Identification) {
        found.long_process =
            Some(Damped { rms_deg_h: self.sigma, frequency_hz: 0.0, decay_time_s: self.time_s });
        if self.excess >= NEAR_EXCESS {
            return;
        }
        for estimate in [&mut found.bias_instability, &mut found.rate_random_walk] {
            if estimate.value.is_some() {
                let note = note!("slow_alike.markov");
                estimate.notes.push(note.with("sigma", self.sigma).with("time_s", self.time_s));
            }
        }
    }
}

/// The best Markov process in place of the flicker or random walk that was chosen; `None` where it is far from as good.
pub(super) fn long_markov(
    joint: &Joint<'_>,
    shape: &Shape,
    choice: SlowChoice,
    prices: &SlowPrices,
) -> Option<LongMarkov> {
    if choice.set & (B | K) == 0 || shape.damped.len() >= MAX_PROCESSES {
        return None;
    }
    let evidence = joint.evidence();
    let longest_s = MAX_TIME_SHARE * evidence.span_s;
    let known_s = shape
        .damped
        .iter()
        .filter(|(kind, _)| *kind == ProcessKind::Markov)
        .map(|(_, d)| d.decay_time_s)
        .fold(0.0, f64::max);
    let mut time_s = MIN_TIME_SAMPLES * evidence.tau0_s.max(known_s);
    let mut tried = vec![];
    while time_s <= longest_s {
        let with = shape.with(ProcessKind::Markov, 0.0, time_s);
        let free = Free { nonlinear: false, ..free_of(&with, 0) };
        tried.push(joint.maximise(&joint.start(&with, &free.variance), &free));
        time_s *= 2.0;
    }
    let best = tried.into_iter().min_by(|a, b| a.deviance.total_cmp(&b.deviance))?;
    if best.deviance + prices.markov > choice.cost + TOLD_EXCESS + MAX_REFINEMENT && choice.set & R == 0 {
        return None;
    }
    let (cost, point) = [(0, prices.markov), (R, prices.markov_and_ramp)]
        .into_iter()
        .map(|(set, price)| {
            let point = fitted(joint, &best, set);
            (point.deviance + price, point)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let time_s = point.shape.damped.last()?.1.decay_time_s;
    let sigma =
        point.variance.get(BASE_TERMS.len() + shape.damped.len()).copied().unwrap_or(0.0).max(0.0).sqrt();
    let excess = cost + prices.in_place_of(choice.set) - choice.cost;
    let usable = sigma > 0.0 && time_s <= longest_s && excess < TOLD_EXCESS;
    usable.then_some(LongMarkov { shape: point.shape, excess, sigma, time_s })
}
