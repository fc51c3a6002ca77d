//! A growing recording by a plan of looks: the look that it has reached, the score that decides there, and what is open.

use super::power::{self, Situation};
use super::reading;
use super::request::Request;
use super::test_kind::{Evidence, Progress, Reading, Run};
use crate::config::procedure::interim_plan::{InterimPlan, Reached};
use crate::config::procedure::limits::LimitSpec;
use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::estimate::{
    Dependence, Estimate, Rule, Verdict, deciding_scores, normal_probability, normal_quantile, spent,
};
use crate::i18n::{Arg, Note, note};
use crate::ingest::Pauses;
use crate::record::{InterimRecord, InterimRow, InterimState, MeasurandRecord, RunRecord};

/// Probability of passing at the full duration below which a row can hardly pass.
const HARDLY: f64 = 0.01;

/// Normal score by which the trend of a row is taken better than it shows when that probability is computed: 95 %.
const FAVOURABLE_SCORE: f64 = 1.645;

/// Part of the sample interval by which a recording may be short of a look: the rounding of a stamp.
const ROUNDED_INTERVAL: f64 = 0.5;

/// The procedure with the look that a recording has reached; `None` without a plan of looks.
///
/// # Errors
/// Those of reading.
pub(super) fn at_reached_look(
    request: &Request<'_>,
    pauses: Pauses,
    progress: Progress<'_>,
) -> Run<Option<Procedure>> {
    let Some(plan) = request.procedure.interim.as_ref().filter(|_| request.is_run()) else { return Ok(None) };
    let channels = reading::channels(request.procedure, request.source);
    let report = reading::plan(request, &channels, pauses)?.stream(&mut [], progress)?;
    let recorded_s = (report.duration_s - request.procedure.conditions.warm_up_s).max(0.0);
    let rounded_s = ROUNDED_INTERVAL * report.tau0_measured_s;
    let looks = plan.looks_s.iter().filter(|look| recorded_s >= *look - rounded_s).count();
    let reached = Some(Reached { looks, recorded_s });
    let interim = Some(InterimPlan { reached, ..plan.clone() });
    Ok(Some(Procedure { interim, ..request.procedure.clone() }))
}

/// A row with a limit and its bounds at the looks.
struct Row {
    spec: LimitSpec,
    channel: String,
    /// True where the record shows a value; a bound alone decides at the full duration only.
    has_value: bool,
    risk: f64,
    information: Vec<f64>,
    dependence: Dependence,
    scores: Vec<f64>,
}

/// The plan at the look that a recording has reached.
pub(super) struct Interim<'p> {
    plan: &'p InterimPlan,
    reached: Reached,
    rows: Vec<Row>,
}

impl<'p> Interim<'p> {
    /// The plan of a reading; `None` without one.
    pub fn of(
        reading: &'p Reading<'_>,
        evidence: &dyn Evidence,
        estimates: &[Estimate],
    ) -> Option<Interim<'p>> {
        let plan = reading.procedure().interim.as_ref()?;
        let reached = plan.reached?;
        let row = |estimate: &Estimate| {
            let spec = reading.request.limits.limit(estimate.id, &estimate.channel)?;
            Some(Row::new(plan, spec, estimate, evidence.situation(&estimate.channel)))
        };
        Some(Interim { plan, reached, rows: estimates.iter().filter_map(row).collect() })
    }

    /// Place of the look that is evaluated; `None` before the first.
    fn at(&self) -> Option<usize> {
        self.reached.looks.checked_sub(1)
    }

    /// True at the full duration.
    fn is_full(&self) -> bool {
        self.reached.looks == self.plan.looks_s.len()
    }

    /// The limits with the risks that the look leaves to each row.
    pub fn limits(&self, limits: &EffectiveLimits) -> EffectiveLimits {
        let mut at_look = limits.clone();
        if let Some(risk) = self.plan.risk {
            at_look.set.limits.iter_mut().for_each(|spec| spec.limit.risk = risk);
            at_look.set.derived.iter_mut().for_each(|spec| spec.risk = risk);
        }
        let own = self.rows.iter().map(|row| {
            let mut spec = row.spec.clone();
            spec.channel = Some(row.channel.clone());
            spec.limit.risk = row.risk_at(self.at());
            spec
        });
        at_look.set.limits.splice(0..0, own);
        at_look
    }

    /// Leaves open what the look cannot decide.
    pub fn settle(&self, rows: &mut [MeasurandRecord], externals: &[String]) {
        for row in rows.iter_mut().filter(|row| row.limit.is_some() && !externals.contains(&row.id)) {
            if !self.is_full() && !self.decides_now(row) {
                row.verdict = Verdict::Indeterminate;
                if let Some(limit) = &mut row.limit {
                    (limit.acceptance_min, limit.acceptance_max) = (None, None);
                }
            }
        }
    }

    fn of_record(&self, record: &MeasurandRecord) -> Option<&Row> {
        self.rows.iter().find(|row| row.spec.measurand.id == record.id && row.channel == record.channel)
    }

    /// True where the look has a bound for a row with a value.
    fn decides_now(&self, record: &MeasurandRecord) -> bool {
        let row = self.of_record(record).filter(|row| row.spec.limit.rule == Rule::GuardBand);
        let score = row.zip(self.at()).and_then(|(row, at)| row.scores.get(at));
        record.value.is_some() && score.is_some_and(|score| score.is_finite())
    }

    /// Writes the plan into the record, and what it leaves open among the reasons.
    pub fn complete(&self, record: &mut RunRecord, externals: &[String]) {
        let limited = record.measurands.iter().filter(|m| m.limit.is_some() && !externals.contains(&m.id));
        let rows: Vec<InterimRow> = limited.map(|m| self.row(m)).collect();
        let has = |state| rows.iter().any(|r: &InterimRow| r.state == state);
        let is_failed = record.measurands.iter().any(|m| m.verdict == Verdict::Fail);
        let state = if is_failed || !rows.is_empty() && rows.iter().all(|r| r.state == InterimState::Decided)
        {
            InterimState::Decided
        } else if has(InterimState::CannotPass) {
            InterimState::CannotPass
        } else if self.is_full() {
            InterimState::Undecided
        } else {
            InterimState::Open
        };
        let next = rows.iter().filter_map(|r| r.decidable_s).reduce(f64::min);
        let interim = InterimRecord {
            spending: "lan_demets_obrien_fleming".to_owned(),
            sides: "one_sided".to_owned(),
            looks_s: self.plan.looks_s.clone(),
            look: self.reached.looks,
            recorded_s: self.reached.recorded_s,
            state,
            next_look_s: next.filter(|_| state == InterimState::Open),
            spent_risk: rows.iter().map(|r| r.spent_risk).fold(0.0, f64::max),
            rows,
        };
        if !self.is_full() {
            // What a look cannot decide is told by the plan, not by the uncertainty of the row.
            let is_open = |note: &Note| {
                let names = note.id.starts_with("summary.row_indeterminate")
                    || note.id.starts_with("summary.row_not_shown");
                names
                    && interim
                        .rows
                        .iter()
                        .any(|r| note.args.get("measurand") == Some(&Arg::key("measurand", &r.id)))
            };
            record.summary.retain(|message| !is_open(message));
        }
        record.summary.extend(said(&interim).into_iter().map(Into::into));
        record.interim = Some(interim);
    }

    fn row(&self, record: &MeasurandRecord) -> InterimRow {
        let row = self.of_record(record);
        let decided = matches!(record.verdict, Verdict::Pass | Verdict::Fail);
        let state = match row {
            _ if decided => InterimState::Decided,
            _ if self.is_full() => InterimState::Undecided,
            Some(row) if row.can_hardly_pass(record, self.at()) => InterimState::CannotPass,
            _ => InterimState::Open,
        };
        let later = || {
            let full = self.plan.looks_s.last().copied();
            let scores = row.map_or(&[][..], |row| &row.scores);
            let next = self.plan.looks_s.iter().zip(scores).skip(self.reached.looks);
            next.filter(|(_, score)| score.is_finite()).map(|(look, _)| *look).next().or(full)
        };
        let finite = |score: &f64| score.is_finite().then_some(*score);
        InterimRow {
            id: record.id.clone(),
            channel: record.channel.clone(),
            risk: row.map_or_else(|| record.limit.as_ref().map_or(0.0, |l| l.risk), |row| row.risk),
            information: row.map(|row| row.information.clone()).unwrap_or_default(),
            exact: row.is_some_and(|row| row.dependence == Dependence::IndependentGains),
            scores: row.map(|row| row.scores.iter().map(finite).collect()).unwrap_or_default(),
            spent_risk: row.map_or(0.0, |row| row.spent_at(self.at(), self.is_full())),
            state,
            decidable_s: (state == InterimState::Open).then(later).flatten(),
        }
    }
}

impl Row {
    fn new(plan: &InterimPlan, spec: &LimitSpec, estimate: &Estimate, situation: Option<Situation>) -> Row {
        let risk = plan.risk.unwrap_or(spec.limit.risk);
        let predicted = situation
            .filter(|_| spec.limit.rule == Rule::GuardBand)
            .and_then(|s| power::variances(spec.measurand, &spec.limit, &s, &plan.looks_s));
        let bounds = predicted.and_then(|(variances, dependence)| {
            let information = shares(plan, &variances, dependence)?;
            let scores = deciding_scores(risk, &information, dependence)?;
            Some((information, dependence, scores))
        });
        let (information, dependence, scores) =
            bounds.unwrap_or_else(|| (vec![], Dependence::Unknown, at_the_end(plan, risk)));
        let (spec, channel, has_value) = (spec.clone(), estimate.channel.clone(), estimate.value.is_some());
        Row { spec, channel, has_value, risk, information, dependence, scores }
    }

    /// Risk of the decision at a look; before the first, where nothing is decided, that of the whole.
    fn risk_at(&self, at: Option<usize>) -> f64 {
        // A bound stands for a score of its own, above that of the last look.
        let score = at.and_then(|at| self.scores.get(at)).filter(|score| self.has_value && score.is_finite());
        score.map_or(self.risk, |score| normal_probability(-score))
    }

    fn spent_at(&self, at: Option<usize>, is_full: bool) -> f64 {
        let share = at.and_then(|at| self.information.get(at)).copied();
        if is_full { self.risk } else { share.map_or(0.0, |t| spent(self.risk, t)) }
    }

    /// Whether the row passes at the full duration with hardly any probability, even by a trend better than it shows.
    fn can_hardly_pass(&self, record: &MeasurandRecord, at: Option<usize>) -> bool {
        let inside = record.specific_risk.map(|risk| -normal_quantile(risk.clamp(1e-15, 1.0 - 1e-15)));
        let share = at.and_then(|at| self.information.get(at)).copied();
        let (Some(score), Some(t), Some(last)) = (inside, share, self.scores.last()) else { return false };
        let trend = (score + FAVOURABLE_SCORE) / t.sqrt();
        let expected = score * t.sqrt() + trend * (1.0 - t);
        normal_probability((expected - last) / (1.0 - t).sqrt()) < HARDLY
    }
}

/// Shares of the information at the looks; `None` where a predicted variance does not fall with time. Where nothing is known of how the
/// looks hang together, the risk is spent by time, which leaves most of it to the full duration.
fn shares(plan: &InterimPlan, variances: &[f64], dependence: Dependence) -> Option<Vec<f64>> {
    let full_s = plan.looks_s.last()?;
    if dependence == Dependence::Unknown {
        return Some(plan.looks_s.iter().map(|look| look / full_s).collect());
    }
    let least = variances.last()?;
    let information: Vec<f64> = variances.iter().map(|variance| least / variance).collect();
    information.windows(2).all(|pair| matches!(pair, [a, b] if a < b)).then_some(information)
}

/// The scores of a row that is decided at the full duration only.
fn at_the_end(plan: &InterimPlan, risk: f64) -> Vec<f64> {
    let mut scores = vec![f64::INFINITY; plan.looks_s.len()];
    if let Some(last) = scores.last_mut() {
        *last = -normal_quantile(risk);
    }
    scores
}

/// Where the test stands, in sentences.
fn said(interim: &InterimRecord) -> Vec<Note> {
    let looks = interim.looks_s.len();
    let reached = match interim.look.checked_sub(1).and_then(|at| interim.looks_s.get(at)) {
        Some(after_s) => note!(
            "interim.reached",
            look = interim.look,
            looks,
            after = Arg::span(*after_s),
            spent = Arg::Number(100.0 * interim.spent_risk)
        ),
        None => note!("interim.before_first", looks, recorded_h = interim.recorded_s / 3600.0),
    };
    let mut open: Vec<Arg> = vec![];
    for row in interim.rows.iter().filter(|r| r.state == InterimState::Open) {
        let name = Arg::key("measurand", &row.id);
        if !open.contains(&name) {
            open.push(name);
        }
    }
    let state = match (interim.state, interim.next_look_s) {
        (InterimState::Open, Some(next_s)) => {
            Some(note!("interim.open", names = Arg::Several(open, "; ".into()), next = Arg::span(next_s)))
        }
        (InterimState::CannotPass, _) => Some(note!("interim.cannot_pass")),
        (InterimState::Decided, _) if interim.look < looks => Some(note!("interim.decided")),
        _ => None,
    };
    std::iter::once(reached).chain(state).collect()
}
