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
    /// Phases of the stretch seen so far.
    seen: u64,
    /// Sum of squared terms and number of terms.
    totals: BTreeMap<(Estimator, u64), (Compensated, u64)>,
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
                totals: BTreeMap::new(),
            })
            .collect();
        let estimators = estimators.iter().copied().filter(|e| *e != Estimator::Total).collect();
        StridedSums { estimators, lanes, prefix: vec![], running: RunningSum::default() }
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
            lane.settle(&self.estimators, &mut self.prefix);
            lane.phases.clear();
            lane.sums.clear();
            lane.open_sum = 0.0;
            lane.seen = 0;
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

    /// Adds up the terms that end in what came since the last time.
    fn settle(&mut self, estimators: &[Estimator], prefix: &mut Vec<f64>) {
        for estimator in estimators {
            if *estimator == Estimator::Modified {
                self.modified(prefix);
            } else {
                self.differences(*estimator);
            }
        }
        let reach = self.reach();
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
