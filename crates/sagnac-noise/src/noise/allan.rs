//! The Allan family of a record that arrives in blocks: σ(τ) of unbroken stretches, pooled.
//!
//! Up to [`MAX_KEPT_SAMPLES`] samples, or at any length on request, the phase is kept and every overlapping term is summed:
//! values agree with the textbook sum to rounding. Beyond, the sums go on in a few MB with steps of at most m/64.
//! A gap splits the record: only terms whose points all lie in unbroken data are used.
//!
//! Source: IEEE Std 952 annex C; Riley, NIST SP 1065 (2008), sections 5.2.4 to 5.2.11.

use super::data::DeviationPoint;
use super::difference_sums::{all_modified, all_overlapping, with_reflection};
use super::family::Estimator;
use super::part::{Head, MergeError, PartStart};
use super::phase::{Compensated, PHASE_BLOCK_SAMPLES, PhaseBuilder, PhaseEnd};
use super::stretches::StretchLengths;
use super::strided::{PhaseShift, StridedSums};
use super::tau_grid::TauGrid;

/// Longest record, in samples, of which every phase is kept (8 bytes each) unless the plan asks for all.
pub const MAX_KEPT_SAMPLES: u64 = 4_000_000;

/// Largest factor at which white angle noise makes a strided record sum every term.
const MAX_DENSE_FACTOR: u64 = 1 << 16;

/// What an [`AllanAccumulator`] computes: which deviations at which averaging times.
#[derive(Debug, Clone, PartialEq)]
pub struct AllanPlan {
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Averaging times. Check the grid first: times that are no multiple of `tau0_s` are rounded here.
    pub grid: TauGrid,
    /// Keeps every phase (8 bytes a sample) and sums every term, whatever the length.
    pub exact: bool,
    /// Deviations wanted.
    pub estimators: Vec<Estimator>,
}

/// One σ(τ) curve, ascending in τ. Deviations in the unit of the samples (deg/h).
#[derive(Debug, Clone, PartialEq)]
pub struct DeviationCurve {
    /// Which deviation.
    pub estimator: Estimator,
    /// Points that have at least one term.
    pub points: Vec<DeviationPoint>,
    /// Samples and lengths of the unbroken stretches that the curve was computed from: all of them, or the longest
    /// one only for the total deviation.
    pub stretches: StretchLengths,
}

/// The σ(τ) curves of one channel, one for each deviation of the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviationSet {
    /// Sample interval, s.
    pub tau0_s: f64,
    /// One curve for each estimator of the plan; a total deviation is left out of a record that was not kept.
    pub curves: Vec<DeviationCurve>,
    /// The unbroken stretches of the record.
    pub stretches: StretchLengths,
}

impl DeviationSet {
    /// The curve of one estimator.
    pub fn curve(&self, estimator: Estimator) -> Option<&DeviationCurve> {
        self.curves.iter().find(|c| c.estimator == estimator)
    }
}

/// The overlapping Allan deviation of an unbroken record at octaves of the sample interval, ascending in averaging time.
///
/// `rate_deg_h` are finite samples taken every `tau0_s` seconds. Each point has its averaging factor `m` (τ = m·`tau0_s`),
/// the number of terms and the deviation in the unit of the samples. Empty for fewer than two samples.
///
/// ```
/// // Samples that alternate between −1 and 1: neighbours differ by 2, so that σ(τ0) = √(4/2), and means of two are all 0.
/// let rate: Vec<f64> = (0..8).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let points = sagnac_noise::noise::allan::allan_deviation(&rate, 0.1);
///
/// assert_eq!(points.iter().map(|p| p.m).collect::<Vec<_>>(), [1, 2, 4]);
/// assert!((points[0].deviation - 2f64.sqrt()).abs() < 1e-12);
/// assert!(points[1].deviation < 1e-12);
/// assert_eq!((points[0].terms, points[1].terms), (7, 5));
/// ```
pub fn allan_deviation(rate_deg_h: &[f64], tau0_s: f64) -> Vec<DeviationPoint> {
    let plan = AllanPlan { tau0_s, grid: TauGrid::Octave, exact: true, estimators: vec![Estimator::Allan] };
    let mut accumulator = AllanAccumulator::new(plan);
    accumulator.push(rate_deg_h, 0, false);
    accumulator.finish().curves.pop().map_or_else(Vec::new, |curve| curve.points)
}

#[derive(Debug, Clone)]
enum Store {
    Kept { phases: Vec<f64>, starts: Vec<usize> },
    Strided(Box<StridedSums>),
}

/// Streaming Allan family of one channel: push samples in blocks of any size, then [`AllanAccumulator::finish`]. Keeps 8 bytes
/// a sample up to [`MAX_KEPT_SAMPLES`], a few MB beyond.
#[derive(Debug, Clone)]
pub struct AllanAccumulator {
    plan: AllanPlan,
    builder: PhaseBuilder,
    store: Store,
    stretches: StretchLengths,
    /// Samples of this part in the current stretch.
    current: u64,
    next_index: u64,
    head: Head,
    /// Where the phase of the stretch that the part continues ended, and after how many samples.
    first_end: Option<(PhaseEnd, u64)>,
}

impl AllanAccumulator {
    /// An empty accumulator.
    pub fn new(plan: AllanPlan) -> Self {
        AllanAccumulator {
            plan,
            builder: PhaseBuilder::default(),
            store: Store::Kept { phases: vec![], starts: vec![] },
            stretches: StretchLengths::default(),
            current: 0,
            next_index: 0,
            head: Head::default(),
            first_end: None,
        }
    }

    /// The accumulator of a part of a recording. `dense_below`: sums go on in bounded memory from the first sample on, every
    /// term up to this factor; else phases are kept as long as those of a whole recording, and the factor is chosen from
    /// them. Parts are merged only with one factor ([`AllanAccumulator::dense_below`]).
    pub fn of_part(plan: AllanPlan, start: PartStart, dense_below: Option<u64>) -> Self {
        let mut part = Self::new(plan);
        part.head = Head::new(start.samples_before, 0);
        part.next_index = start.first_index;
        if start.samples_before > 0 {
            part.builder = PhaseBuilder::continued();
        }
        if let Some(dense) = dense_below.filter(|_| !part.plan.exact) {
            part.store = Store::Strided(Box::new(part.sums(dense)));
        }
        part
    }

    /// Averaging factor up to which strided sums take every term; `None` while every phase is kept.
    pub fn dense_below(&self) -> Option<u64> {
        match &self.store {
            Store::Kept { .. } => None,
            Store::Strided(sums) => Some(sums.dense_below()),
        }
    }

    /// Adds the next part of the recording. Terms are those of one pass, their sums agree to rounding.
    ///
    /// # Errors
    /// Where the part begins elsewhere than this one ends, or the two sum other terms.
    pub fn merge(&mut self, mut later: AllanAccumulator) -> Result<(), MergeError> {
        if later.head.is_empty() {
            return Ok(());
        }
        self.head.accepts(&later.head)?;
        let alike = match (&self.store, &later.store) {
            (Store::Strided(sums), Store::Strided(later)) => sums.matches(later),
            _ => true,
        };
        if self.plan != later.plan || !alike {
            return Err(MergeError::Settings);
        }
        if self.head.is_empty() && later.head.begun().is_some() {
            *self = later;
            return Ok(());
        }
        let joint = later.head.begun().and_then(|origin| self.joint(&mut later, origin));
        if joint.is_none() {
            self.end_stretch();
        }
        if let (Store::Kept { .. }, Some(dense)) = (&self.store, later.dense_below()) {
            self.stop_keeping(Some(dense));
        }
        match (&mut self.store, later.store) {
            (Store::Strided(sums), Store::Strided(later)) => sums.merge(*later, joint.map(|j| j.shift)),
            (store, Store::Kept { mut phases, starts }) => {
                if let Some(Joint { shift, .. }) = joint {
                    let first = starts.get(1).copied().unwrap_or(phases.len());
                    for (number, x) in (shift.origin + 1..).zip(phases.iter_mut().take(first)) {
                        *x += shift.at(number);
                    }
                }
                store.append(&phases, &starts, joint.is_some());
            }
            // Phases that were kept before strided sums have been given over above.
            (Store::Kept { .. }, Store::Strided(_)) => {}
        }
        match joint {
            Some(Joint { end, ended: Some(samples), .. }) => {
                self.close((end, self.current + samples));
                (self.builder, self.current) = (later.builder, later.current);
            }
            Some(Joint { end, ended: None, .. }) => {
                self.builder.go_on(end);
                self.current += later.current;
            }
            None => (self.builder, self.current) = (later.builder, later.current),
        }
        self.stretches.merge(&later.stretches);
        self.next_index = later.next_index;
        self.head.follow(&later.head);
        self.bound_memory();
        Ok(())
    }

    /// How the phases of a later part join those of this one, of whose stretch `origin` samples precede it.
    fn joint(&mut self, later: &mut AllanAccumulator, origin: u64) -> Option<Joint> {
        let store = &mut self.store;
        let here = self.builder.flushed(&mut |x| store.extend(x))?;
        let ended = later.first_end;
        let store = &mut later.store;
        let current = later.builder.flushed(&mut |x| store.extend(x));
        let (there, samples) = match ended {
            Some(first) => first,
            None => (current?, later.current),
        };
        let slope = there.reference - here.reference;
        let mut phase = here.phase;
        phase.add_sum(there.phase);
        phase.add(slope * samples as f64);
        Some(Joint {
            shift: PhaseShift { origin, offset: here.phase.value(), slope },
            end: PhaseEnd { phase, reference: here.reference },
            ended: ended.map(|e| e.1),
        })
    }

    /// Takes finite contiguous samples, deg/h. `continues` says that they follow the last ones without a gap; a
    /// `first_index` that does not follow starts a new stretch all the same.
    pub fn push(&mut self, samples: &[f64], first_index: u64, continues: bool) {
        if samples.is_empty() {
            return;
        }
        let continues = continues && first_index == self.next_index;
        if !continues {
            self.end_stretch();
        }
        self.head.take(samples, continues);
        let store = &mut self.store;
        let starts = self.current == 0;
        if let (true, Store::Kept { phases, starts }) = (starts, &mut *store) {
            starts.push(phases.len());
        }
        self.builder.push(samples, &mut |x| store.extend(x));
        self.current += samples.len() as u64;
        self.next_index = first_index.saturating_add(samples.len() as u64);
        self.bound_memory();
    }

    fn bound_memory(&mut self) {
        let first = self.first_end.map_or(0, |e| e.1);
        if !self.plan.exact && self.stretches.samples() + first + self.current > MAX_KEPT_SAMPLES {
            self.stop_keeping(None);
        }
    }

    /// The curves of everything pushed so far.
    pub fn finish(mut self) -> DeviationSet {
        self.end_stretch();
        self.stretches.add(self.first_end.map_or(0, |e| e.1));
        let longest = self.stretches.longest();
        let mut curves = vec![];
        for &estimator in &self.plan.estimators {
            let factors = self.plan.grid.factors(
                self.plan.tau0_s,
                Some(self.stretches.samples()),
                longest / estimator.span(),
            );
            let points = match &self.store {
                Store::Kept { phases, starts } => kept_points(estimator, &factors, phases, starts),
                Store::Strided(_) if estimator == Estimator::Total => continue,
                Store::Strided(sums) => sums.points(estimator),
            };
            let stretches = if estimator == Estimator::Total {
                StretchLengths::of(longest)
            } else {
                self.stretches.clone()
            };
            curves.push(DeviationCurve { estimator, points, stretches });
        }
        DeviationSet { tau0_s: self.plan.tau0_s, curves, stretches: self.stretches }
    }

    fn end_stretch(&mut self) {
        if self.current > 0 {
            let store = &mut self.store;
            let end = self.builder.flushed(&mut |x| store.extend(x));
            if let Store::Strided(sums) = store {
                sums.end_stretch();
            }
            if let Some(end) = end {
                self.close((end, self.current));
            }
            self.current = 0;
        } else if self.head.is_leading()
            && let Store::Strided(sums) = &mut self.store
        {
            // A gap comes before the first sample of the part.
            sums.begin();
        }
        self.head.end_stretch();
        self.builder.end_stretch(&mut |_| {});
    }

    /// Closes a stretch: that which the part continues waits for the part before.
    fn close(&mut self, stretch: (PhaseEnd, u64)) {
        if self.head.is_leading() {
            self.first_end = Some(stretch);
        } else {
            self.stretches.add(stretch.1);
        }
    }

    /// Strided sums for the stretch that the part begins with.
    fn sums(&self, dense_below: u64) -> StridedSums {
        let factors = self.plan.grid.factors(self.plan.tau0_s, None, u64::MAX);
        let mut sums = StridedSums::new(&self.plan.estimators, &factors, dense_below);
        if let Some(before) = self.head.begun() {
            sums.continue_from(before + 1);
        }
        sums
    }

    /// Goes over from kept phases to strided sums, which get everything kept so far.
    fn stop_keeping(&mut self, dense_below: Option<u64>) {
        let Store::Kept { phases, starts } = &mut self.store else { return };
        let (phases, starts) = (std::mem::take(phases), std::mem::take(starts));
        let dense = dense_below.unwrap_or_else(|| white_angle_reach(&phases, &starts));
        self.store = Store::Strided(Box::new(self.sums(dense)));
        self.store.append(&phases, &starts, true);
    }
}

/// How two parts of one stretch join.
#[derive(Debug, Clone, Copy)]
struct Joint {
    shift: PhaseShift,
    /// Where the phase stands at the end of the stretch in the later part.
    end: PhaseEnd,
    /// Samples of the stretch in the later part, where it has ended there.
    ended: Option<u64>,
}

impl Store {
    fn extend(&mut self, block: &[f64]) {
        match self {
            Store::Kept { phases, .. } => phases.extend_from_slice(block),
            Store::Strided(sums) => sums.push(block),
        }
    }

    /// Appends the phases of whole stretches; `continues`: the first goes on with the current one.
    fn append(&mut self, phases: &[f64], starts: &[usize], continues: bool) {
        match self {
            Store::Kept { phases: kept, starts: kept_starts } => {
                let from = kept.len();
                kept_starts.extend(starts.iter().skip(usize::from(continues)).map(|at| from + at));
                kept.extend_from_slice(phases);
            }
            Store::Strided(sums) => {
                for (k, stretch) in stretches_of(phases, starts).enumerate() {
                    if k > 0 || !continues {
                        sums.end_stretch();
                    }
                    stretch.chunks(PHASE_BLOCK_SAMPLES).for_each(|block| sums.push(block));
                }
            }
        }
    }
}

fn stretches_of<'a>(phases: &'a [f64], starts: &'a [usize]) -> impl Iterator<Item = &'a [f64]> + 'a {
    starts.iter().enumerate().map(|(k, &from)| {
        let to = starts.get(k + 1).copied().unwrap_or(phases.len());
        phases.get(from..to).unwrap_or_default()
    })
}

/// Averaging factor below which white angle noise rules: σ falls nearly as 1/τ over the octave. There a strided sum
/// would lose degrees of freedom in proportion to the terms left out.
fn white_angle_reach(phases: &[f64], starts: &[usize]) -> u64 {
    let octaves = TauGrid::Octave.factors(1.0, None, 2 * MAX_DENSE_FACTOR);
    let points = kept_points(Estimator::Allan, &octaves, phases, starts);
    let steep = |w: &&[DeviationPoint]| w[1].deviation < 0.6 * w[0].deviation;
    points.windows(2).filter(steep).map(|w| 2 * w[1].m).max().unwrap_or(0).min(2 * MAX_DENSE_FACTOR)
}

fn kept_points(
    estimator: Estimator,
    factors: &[u64],
    phases: &[f64],
    starts: &[usize],
) -> Vec<DeviationPoint> {
    let mut sums = vec![Compensated::default(); factors.len()];
    let mut terms = vec![0u64; factors.len()];
    let longest = stretches_of(phases, starts).max_by_key(|x| x.len());
    let every = stretches_of(phases, starts).filter(|_| estimator != Estimator::Total);
    let only = longest.filter(|_| estimator == Estimator::Total);
    for x in every.chain(only) {
        let samples = x.len().saturating_sub(1) as u64;
        let usable = factors.partition_point(|m| m.saturating_mul(estimator.span()) <= samples);
        let factors = &factors[..usable];
        let of_stretch = match estimator {
            Estimator::Modified => all_modified(x, factors),
            _ => all_overlapping(x, factors, estimator.span() as usize),
        };
        for (k, (&m, sum)) in factors.iter().zip(of_stretch).enumerate() {
            let sum = if estimator == Estimator::Total { with_reflection(x, m as usize, sum) } else { sum };
            sums[k].add(sum);
            terms[k] += estimator.terms(samples, m, 1);
        }
    }
    let point = |((&m, sum), &terms): ((&u64, &Compensated), &u64)| {
        let deviation = estimator.deviation(sum.value(), terms, m)?;
        Some(DeviationPoint { m, terms, stride: 1, deviation })
    };
    factors.iter().zip(&sums).zip(&terms).filter_map(point).collect()
}

#[cfg(test)]
#[path = "allan_tests.rs"]
mod tests;
