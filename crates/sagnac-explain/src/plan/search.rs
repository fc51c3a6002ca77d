//! The shortest schedule that decides: every pattern is worked out once, the promising ones are repeated as often as they need.

use super::library::Pattern;
use super::separation::{Decision, Shown, found, told_apart};
use super::trial::Trial;
use crate::claim::{Claim, Stated};
use crate::numeric::order::SortByNumber;
use crate::numeric::parallel;
use crate::schedule::{Schedule, Start};

/// Probability of deciding that is asked for.
pub const ASKED: f64 = 0.95;
/// Patterns that are repeated as often as they need.
const PROMISING: usize = 8;
/// Repetitions of the chosen schedule up to which the length that it would need is looked for.
const MAX_REPETITIONS: u32 = 128;

/// A cause with its explanations as a later record shows them, the chosen one first; `None`: nothing of it.
pub(super) struct Question {
    pub shown: Vec<Option<Stated>>,
}

/// A schedule with what it tells.
#[derive(Clone)]
pub(super) struct Evaluated {
    pub schedule: Schedule,
    pub causes: Vec<Vec<Answer>>,
}

/// Decision that a record allows if one explanation is true.
#[derive(Clone)]
pub(super) struct Answer {
    pub found: Decision,
    /// Against every explanation of the cause; that against itself is left out.
    pub pairs: Vec<(usize, Decision)>,
}

impl Answer {
    /// Probability of naming it alone: at least one less the probabilities of everything that can go wrong.
    pub fn alone(&self) -> f64 {
        let missed = self.pairs.iter().map(|(_, d)| 1.0 - d.probability).sum::<f64>();
        (self.found.probability - missed).max(0.0)
    }
}

impl Evaluated {
    /// Smallest probability of naming what is true alone.
    pub fn least(&self) -> f64 {
        self.causes.iter().flatten().map(Answer::alone).fold(1.0, f64::min)
    }

    pub fn decides(&self) -> bool {
        self.least() >= ASKED
    }

    /// Parts of what is needed that are reached, one a decision.
    fn reached(&self) -> Vec<f64> {
        let one = |a: &Answer| {
            std::iter::once(a.found.reached).chain(a.pairs.iter().map(|(_, d)| d.reached)).collect::<Vec<_>>()
        };
        self.causes.iter().flatten().flat_map(one).collect()
    }

    fn hours(&self) -> f64 {
        self.schedule.duration_s() / 3600.0
    }

    /// Hours that it would need, if every hour told as much as the first ones.
    fn expected_hours(&self) -> f64 {
        let least = self.reached().into_iter().fold(1.0, f64::min);
        self.hours() / least.max(1e-9)
    }
}

/// Everything that a search needs.
pub(super) struct Search<'a> {
    pub claim: &'a Claim,
    pub questions: &'a [Question],
    pub start: Start,
    pub budget_s: f64,
}

/// What a search found.
pub(super) struct Found {
    /// The best first.
    pub ranked: Vec<Evaluated>,
    /// Length at which the best decides when it is repeated beyond the budget, s.
    pub needed_s: Option<f64>,
}

impl Search<'_> {
    /// What a schedule tells; `None` where an explanation cannot be worked out in it.
    pub fn evaluate(&self, schedule: Schedule) -> Option<Evaluated> {
        let trial = Trial::new(&schedule, self.claim)?;
        let causes = self.questions.iter().map(|q| self.answers(q, &trial)).collect::<Option<Vec<_>>>()?;
        Some(Evaluated { schedule, causes })
    }

    fn answers(&self, question: &Question, trial: &Trial) -> Option<Vec<Answer>> {
        let shown: Vec<Shown> = question
            .shown
            .iter()
            .map(|s| Shown::new(s.as_ref(), self.claim, trial))
            .collect::<Option<Vec<_>>>()?;
        // Everything that can go wrong shares what may go wrong.
        let asked = 1.0 - (1.0 - ASKED) / shown.len() as f64;
        let answer = |(i, truth): (usize, &Shown)| {
            let others = shown.iter().enumerate().filter(|(j, _)| *j != i);
            let pairs = others.map(|(j, rival)| (j, told_apart(truth, rival, trial, asked))).collect();
            Answer { found: found(truth, self.claim, trial, asked), pairs }
        };
        Some(shown.iter().enumerate().map(answer).collect())
    }

    fn repeated(&self, pattern: &Pattern, times: u32) -> Schedule {
        let steps = (0..times).flat_map(|_| pattern.clone()).collect();
        Schedule { start: self.start, steps }.joined()
    }

    fn repetitions(&self, pattern: &Pattern, budget_s: f64) -> u32 {
        let once = self.repeated(pattern, 1).duration_s();
        // A first approach to the low end is not repeated, so that this is never too many.
        if once > 0.0 { (budget_s / once).floor().clamp(0.0, f64::from(MAX_REPETITIONS)) as u32 } else { 0 }
    }

    /// The fewest repetitions that decide, or the most that the budget allows.
    fn enough(&self, pattern: &Pattern, budget_s: f64) -> Option<Evaluated> {
        let most = self.repetitions(pattern, budget_s);
        let at = |times: u32| self.evaluate(self.repeated(pattern, times));
        let (mut low, mut times) = (0, 1u32);
        let mut last = None;
        while times <= most {
            let evaluated = at(times)?;
            if evaluated.decides() {
                let mut best = evaluated;
                while times - low > 1 {
                    let middle = low + (times - low) / 2;
                    match at(middle)? {
                        e if e.decides() => (times, best) = (middle, e),
                        _ => low = middle,
                    }
                }
                return Some(best);
            }
            last = Some(evaluated);
            if times == most {
                break;
            }
            low = times;
            times = (2 * times).min(most);
        }
        last
    }

    /// The best schedule of given patterns, with those that were compared to it.
    pub fn best(&self, patterns: &[Pattern], progress: &mut dyn FnMut(u64, u64)) -> Found {
        let total = 3;
        progress(0, total);
        let once: Vec<(Pattern, Evaluated)> =
            parallel::map_items(patterns, |p| Some((p.clone(), self.evaluate(self.repeated(p, 1))?)))
                .into_iter()
                .flatten()
                .collect();
        progress(1, total);
        let mut promising = self.promising(&once);
        promising.extend(self.combined(&once));
        let mut ranked: Vec<Evaluated> = parallel::map_items(&promising, |p| self.enough(p, self.budget_s))
            .into_iter()
            .flatten()
            .collect();
        progress(2, total);
        rank(&mut ranked);
        let needed_s = match ranked.first() {
            Some(best) if !best.decides() && best.least() < ASKED => {
                let pattern = best.schedule.steps.clone();
                let longer = self.enough(&pattern, f64::from(MAX_REPETITIONS) * best.schedule.duration_s());
                longer.filter(Evaluated::decides).map(|e| e.schedule.duration_s())
            }
            _ => None,
        };
        progress(total, total);
        Found { ranked, needed_s }
    }

    /// The patterns that are expected to decide in the fewest hours.
    fn promising(&self, once: &[(Pattern, Evaluated)]) -> Vec<Pattern> {
        let mut order: Vec<&(Pattern, Evaluated)> = once.iter().collect();
        order.sort_ascending_by(|a| a.1.expected_hours());
        order.into_iter().take(PROMISING).map(|(p, _)| p.clone()).collect()
    }

    /// The best patterns of each decision one after the other, where not all are the same.
    fn combined(&self, once: &[(Pattern, Evaluated)]) -> Option<Pattern> {
        let decisions = once.first()?.1.reached().len();
        let mut chosen: Vec<&Pattern> = vec![];
        for i in 0..decisions {
            let worth = |e: &Evaluated| e.reached().get(i).copied().unwrap_or(0.0) / e.hours();
            let best = once.iter().max_by(|a, b| worth(&a.1).total_cmp(&worth(&b.1)))?;
            if !chosen.contains(&&best.0) {
                chosen.push(&best.0);
            }
        }
        (chosen.len() > 1).then(|| chosen.into_iter().flatten().cloned().collect())
    }
}

/// Orders schedules: those that decide first, the shortest of them first; then by what they reach.
fn rank(schedules: &mut [Evaluated]) {
    schedules.sort_by(|a, b| {
        let sum = |e: &Evaluated| e.reached().iter().sum::<f64>();
        let by_reach = || b.least().total_cmp(&a.least()).then(sum(b).total_cmp(&sum(a)));
        match (a.decides(), b.decides()) {
            (true, true) => a.hours().total_cmp(&b.hours()),
            (true, false) => std::cmp::Ordering::Less,
            (false, true) => std::cmp::Ordering::Greater,
            (false, false) => by_reach(),
        }
    });
}
