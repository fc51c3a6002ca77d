//! The Allan family in bounded memory, for records too long to keep.
//!
//! Terms at averaging factor m are summed at steps of at most m/64. The terms left out overlap their neighbours by
//! more than 98 %, so for white, flicker and random-walk rate less than 1 % of the degrees of freedom is lost. Factors
//! that share a step share a lane: a short queue of phases (and of sums of phases, for the modified deviation) on the
//! grid of that step.

use super::data::DeviationPoint;
use super::difference_sums::ending_from;
use super::family::Estimator;
use super::phase::Compensated;
use super::tau_grid::widest_stride;
use std::collections::BTreeMap;

/// Factors with one step between terms, and the phases that they still need.
#[derive(Debug, Clone)]
struct Lane {
    stride: usize,
    /// Averaging factors in samples, ascending, and in steps.
    factors: Vec<(u64, usize)>,
    phases: Queue,
    /// Sums of phase over the steps.
    sums: Queue,
    /// Sum over the step that is not complete.
    open_sum: f64,
    /// Phases of the stretch seen so far, those before the part included.
    seen: u64,
    /// Of a part that continues a stretch.
    head: Option<LaneHead>,
    /// Sum of squared terms and number of terms.
    totals: BTreeMap<(Estimator, u64), (Compensated, u64)>,
}

/// How the phases of a later part are moved to those of the part before it: by `offset`, and by `slope` a sample from
/// phase number `origin` on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PhaseShift {
    pub origin: u64,
    pub offset: f64,
    pub slope: f64,
}

impl PhaseShift {
    /// Offset of a phase.
    pub(crate) fn at(self, number: u64) -> f64 {
        self.offset + self.slope * (number - self.origin) as f64
    }

    /// Offset of the sum of `count` phases from number `from` on.
    fn of_sum(self, from: u64, count: u64) -> f64 {
        let n = count as f64;
        n * self.at(from) + self.slope * 0.5 * n * (n - 1.0)
    }
}

/// What a lane of a part holds back of the stretch that it continues.
#[derive(Debug, Clone, Default)]
struct LaneHead {
    /// Number of the first phase of the part.
    from: u64,
    /// Phases and sums on the grid of the lane, until they are as many as the longest term spans.
    phases: Vec<f64>,
    sums: Vec<f64>,
    /// Sum over the step that was open before the part, once it is complete.
    lead: Option<f64>,
    /// Whether terms lie beyond.
    full: bool,
    /// Number of the phase after the last one, and the sum over the open step, once the stretch has ended.
    end: Option<(u64, f64)>,
}

impl LaneHead {
    /// Number of the first phase on the grid of a lane.
    fn first(&self, stride: usize) -> u64 {
        self.from.next_multiple_of(stride as u64)
    }

    /// Copies up to `most` values of the queues, whose terms before are left to the merge. The sum over the step that was
    /// open before the part leaves its queue.
    fn fill(&mut self, phases: &mut Queue, sums: &mut Queue, stride: usize, most: usize) {
        if self.from < self.first(stride) && !sums.values.is_empty() {
            self.lead = Some(sums.values.remove(0));
        }
        let copied = |queue: &mut Queue| {
            queue.fresh = queue.values.len().min(most);
            queue.values.iter().take(most).copied().collect()
        };
        self.phases = copied(phases);
        self.sums = copied(sums);
    }
}

/// The newest values, with what is old dropped now and then rather than each time.
#[derive(Debug, Clone, Default)]
struct Queue {
    values: Vec<f64>,
    fresh: usize,
}

impl Queue {
    fn trim(&mut self, keep: usize) {
        let surplus = self.values.len().saturating_sub(keep);
        if surplus > keep.max(1024) {
            self.values.drain(..surplus);
        }
        self.fresh = self.values.len();
    }

    fn clear(&mut self) {
        self.values.clear();
        self.fresh = 0;
    }
}

/// Sums of squared terms for any length of record.
#[derive(Debug, Clone)]
pub(crate) struct StridedSums {
    estimators: Vec<Estimator>,
    lanes: Vec<Lane>,
    dense_below: u64,
    prefix: Vec<f64>,
    running: RunningSum,
}

/// Sums over any part of a block of phases, taken about the first phase so that they keep their digits.
#[derive(Debug, Clone, Default)]
struct RunningSum {
    reference: f64,
    upto: Vec<f64>,
}

impl RunningSum {
    fn set(&mut self, phases: &[f64]) {
        self.reference = phases.first().copied().unwrap_or(0.0);
        self.upto.clear();
        self.upto.push(0.0);
        let mut running = 0.0;
        self.upto.extend(phases.iter().map(|x| {
            running += x - self.reference;
            running
        }));
    }

    fn between(&self, from: usize, to: usize) -> f64 {
        match (self.upto.get(from), self.upto.get(to)) {
            (Some(a), Some(b)) => (b - a) + (to - from) as f64 * self.reference,
            _ => 0.0,
        }
    }
}

impl StridedSums {
    /// Sums for these averaging factors. Up to `dense_below` every term is summed, which white angle noise needs.
    pub(crate) fn new(estimators: &[Estimator], factors: &[u64], dense_below: u64) -> Self {
        let mut by_stride: BTreeMap<usize, Vec<(u64, usize)>> = BTreeMap::new();
        for &m in factors {
            let stride = if m < dense_below { 1 } else { widest_stride(m) };
            by_stride.entry(stride as usize).or_default().push((m, (m / stride) as usize));
        }
        let lanes = by_stride
            .into_iter()
            .map(|(stride, factors)| Lane {
                stride,
                factors,
                phases: Queue::default(),
                sums: Queue::default(),
                open_sum: 0.0,
                seen: 0,
                head: None,
                totals: BTreeMap::new(),
            })
            .collect();
        let estimators = estimators.iter().copied().filter(|e| *e != Estimator::Total).collect();
        StridedSums { estimators, lanes, dense_below, prefix: vec![], running: RunningSum::default() }
    }

    /// Up to which factor every term is summed.
    pub(crate) fn dense_below(&self) -> u64 {
        self.dense_below
    }

    /// Makes these the sums of a part whose first phase has the number `from` in its stretch.
    pub(crate) fn continue_from(&mut self, from: u64) {
        for lane in &mut self.lanes {
            lane.seen = from;
            lane.head = Some(LaneHead { from, ..LaneHead::default() });
        }
    }

    /// Makes these the sums of a stretch that begins here.
    pub(crate) fn begin(&mut self) {
        for lane in &mut self.lanes {
            (lane.seen, lane.head) = (0, None);
        }
    }

    /// Whether the sums of a later part are over the same terms.
    pub(crate) fn matches(&self, later: &StridedSums) -> bool {
        let terms = |sums: &StridedSums| -> Vec<(usize, Vec<(u64, usize)>)> {
            sums.lanes.iter().map(|lane| (lane.stride, lane.factors.clone())).collect()
        };
        self.estimators == later.estimators && terms(self) == terms(later)
    }

    /// Adds the sums of the next part. `shift` moves the phases of the stretch that it continues; `None`: it continues
    /// none. The sums of both must match.
    pub(crate) fn merge(&mut self, later: StridedSums, shift: Option<PhaseShift>) {
        if shift.is_none() {
            self.end_stretch();
        }
        for (lane, later) in self.lanes.iter_mut().zip(later.lanes) {
            lane.settle(&self.estimators, &mut self.prefix);
            lane.merge(later, shift, &self.estimators, &mut self.prefix);
        }
    }

    /// Takes the next phases of the current stretch.
    pub(crate) fn push(&mut self, phases: &[f64]) {
        let modified = self.estimators.contains(&Estimator::Modified);
        if modified {
            self.running.set(phases);
        }
        for lane in &mut self.lanes {
            lane.take(phases, modified.then_some(&self.running));
            // As much anew as is kept: a long queue is then gone through a few times in all, not once a block.
            if lane.phases.values.len() - lane.phases.fresh >= lane.reach().max(256) {
                lane.settle(&self.estimators, &mut self.prefix);
            }
        }
    }

    /// Ends the stretch: no term reaches across.
    pub(crate) fn end_stretch(&mut self) {
        for lane in &mut self.lanes {
            lane.end_stretch(&self.estimators, &mut self.prefix);
        }
    }

    /// The points of one estimator over the stretches that have ended, ascending.
    pub(crate) fn points(&self, estimator: Estimator) -> Vec<DeviationPoint> {
        let mut points: Vec<DeviationPoint> = self
            .lanes
            .iter()
            .flat_map(|lane| lane.totals.iter().map(|entry| (lane.stride as u64, entry)))
            .filter(|(_, ((e, _), _))| *e == estimator)
            .filter_map(|(stride, ((_, m), (sum, terms)))| {
                let deviation = estimator.deviation(sum.value(), *terms, *m)?;
                Some(DeviationPoint { m: *m, terms: *terms, stride, deviation })
            })
            .collect();
        points.sort_by_key(|p| p.m);
        points
    }
}

impl Lane {
    /// Steps that the longest term spans.
    fn reach(&self) -> usize {
        3 * self.factors.last().map_or(0, |f| f.1)
    }

    /// Ends the stretch.
    fn end_stretch(&mut self, estimators: &[Estimator], prefix: &mut Vec<f64>) {
        self.settle(estimators, prefix);
        let (seen, open) = (self.seen, self.open_sum);
        if let Some(head) = self.head.as_mut().filter(|h| h.end.is_none()) {
            if !head.full {
                head.fill(&mut self.phases, &mut self.sums, self.stride, usize::MAX);
            }
            head.end = Some((seen, open));
        }
        self.phases.clear();
        self.sums.clear();
        self.open_sum = 0.0;
        self.seen = 0;
    }

    /// Adds the sums of the same lane of the next part.
    fn merge(
        &mut self,
        mut later: Lane,
        shift: Option<PhaseShift>,
        estimators: &[Estimator],
        prefix: &mut Vec<f64>,
    ) {
        let head = later.head.take().zip(shift);
        if let Some((mut head, shift)) = head {
            if !head.full && head.end.is_none() {
                let (mut phases, mut sums) = (later.phases.clone(), later.sums.clone());
                head.fill(&mut phases, &mut sums, later.stride, usize::MAX);
            }
            let (seen, open) = head.end.unwrap_or((later.seen, later.open_sum));
            self.replay(&head, shift, seen, open);
            self.settle(estimators, prefix);
            match (head.end, head.full) {
                (Some(_), _) => {
                    self.end_stretch(estimators, prefix);
                    self.take_over(later.phases, later.sums, later.open_sum, later.seen);
                }
                (None, true) => {
                    later.shift_queues(shift);
                    self.take_over(later.phases, later.sums, self.open_sum, later.seen);
                }
                (None, false) => {}
            }
        } else {
            self.take_over(later.phases, later.sums, later.open_sum, later.seen);
        }
        for (key, (sum, terms)) in later.totals {
            let total = self.totals.entry(key).or_default();
            total.0.add_sum(sum);
            total.1 += terms;
        }
    }

    fn take_over(&mut self, phases: Queue, sums: Queue, open_sum: f64, seen: u64) {
        (self.phases, self.sums, self.open_sum, self.seen) = (phases, sums, open_sum, seen);
    }

    /// Takes what a later part held back, its phases moved by `shift`. `seen` and `open` are those at its end.
    fn replay(&mut self, head: &LaneHead, shift: PhaseShift, seen: u64, open: f64) {
        let stride = self.stride as u64;
        let first = head.first(self.stride);
        let at = |k: usize| first + k as u64 * stride;
        self.phases.values.extend(head.phases.iter().enumerate().map(|(k, x)| x + shift.at(at(k))));
        if first > seen {
            // Not even the open step was completed.
            self.open_sum += open + shift.of_sum(head.from, seen - head.from);
            self.seen = seen;
            return;
        }
        if let Some(lead) = head.lead {
            let lead = lead + shift.of_sum(head.from, first - head.from);
            self.sums.values.push(self.open_sum + lead);
        }
        self.sums.values.extend(head.sums.iter().enumerate().map(|(k, s)| s + shift.of_sum(at(k), stride)));
        let complete = (seen / stride * stride).max(first);
        self.open_sum = open + shift.of_sum(complete, seen - complete);
        self.seen = seen;
    }

    /// Moves what is kept for later terms.
    fn shift_queues(&mut self, shift: PhaseShift) {
        let stride = self.stride as u64;
        let last = self.seen.saturating_sub(1) / stride;
        let phases = self.phases.values.iter_mut().rev().zip((0..=last).rev());
        phases.for_each(|(x, step)| *x += shift.at(step * stride));
        let sums = self.sums.values.iter_mut().rev().zip((0..self.seen / stride).rev());
        sums.for_each(|(s, step)| *s += shift.of_sum(step * stride, stride));
    }

    /// Adds up the terms that end in what came since the last time.
    fn settle(&mut self, estimators: &[Estimator], prefix: &mut Vec<f64>) {
        let reach = self.reach();
        let modified = estimators.contains(&Estimator::Modified);
        if let Some(head) = self.head.as_mut().filter(|h| !h.full && h.end.is_none()) {
            let lead = usize::from(head.from < head.first(self.stride));
            let sums = if modified { reach + lead } else { 0 };
            if self.phases.values.len() < reach || self.sums.values.len() < sums {
                return;
            }
            head.full = true;
            head.fill(&mut self.phases, &mut self.sums, self.stride, reach);
        }
        for estimator in estimators {
            if *estimator == Estimator::Modified {
                self.modified(prefix);
            } else {
                self.differences(*estimator);
            }
        }
        self.phases.trim(reach);
        self.sums.trim(reach);
    }

    fn take(&mut self, phases: &[f64], running: Option<&RunningSum>) {
        let stride = self.stride;
        let first = (self.seen.next_multiple_of(stride as u64) - self.seen) as usize;
        if stride == 1 {
            self.phases.values.extend_from_slice(phases);
            if running.is_some() {
                self.sums.values.extend_from_slice(phases);
            }
        } else {
            if let Some(from) = phases.get(first..) {
                self.phases.values.extend(from.iter().step_by(stride));
            }
            if let Some(running) = running {
                self.take_sums(running, first, phases.len());
            }
        }
        self.seen += phases.len() as u64;
    }

    fn take_sums(&mut self, running: &RunningSum, first: usize, len: usize) {
        self.open_sum += running.between(0, first.min(len));
        if first > len {
            return;
        }
        if first > 0 {
            self.sums.values.push(self.open_sum);
            self.open_sum = 0.0;
        }
        let steps = (len - first) / self.stride;
        let edges = (0..steps).map(|k| first + k * self.stride);
        self.sums.values.extend(edges.map(|from| running.between(from, from + self.stride)));
        self.open_sum += running.between(first + steps * self.stride, len);
    }

    fn differences(&mut self, estimator: Estimator) {
        let order = estimator.span() as usize;
        for &(m, lag) in &self.factors {
            let (sum, terms) = ending_from(&self.phases.values, lag, order, self.phases.fresh);
            if terms > 0 {
                let total = self.totals.entry((estimator, m)).or_default();
                total.0.add(sum);
                total.1 += terms;
            }
        }
    }

    fn modified(&mut self, prefix: &mut Vec<f64>) {
        if self.sums.fresh == self.sums.values.len() {
            return;
        }
        let (Some(&origin), values) = (self.sums.values.first(), &self.sums.values) else { return };
        prefix.clear();
        prefix.push(0.0);
        let mut running = 0.0;
        prefix.extend(values.iter().map(|v| {
            running += v - origin;
            running
        }));
        for &(m, lag) in &self.factors {
            let (sum, terms) = ending_from(prefix, lag, 3, self.sums.fresh + 1);
            if terms > 0 {
                let total = self.totals.entry((Estimator::Modified, m)).or_default();
                total.0.add(sum);
                total.1 += terms;
            }
        }
    }
}
