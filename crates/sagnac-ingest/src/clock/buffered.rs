//! Host time stamps in bursts: samples of a uniform clock that a logger writes batch by batch, each stamped when it is
//! written.
//!
//! Within a batch the stamps step by the time a transfer takes, between batches they pause. A batch may have any number
//! of rows. Either the last row of a batch is stamped right after it was sampled (delivery on request) or the first one
//! is (coarse stamps): these rows, the *anchors*, lie on the line of the uniform clock but for a delay that is bounded
//! and does not grow. Lost samples lift that line for good, a late delivery only until the next batch.

use super::steps::{StampedRow, steps};

/// Steps that end a batch, in mean intervals.
pub(super) const PAUSE: f64 = 1.2;

/// Largest middle step of stamps in batches, in mean intervals.
const WITHIN: f64 = 0.8;

/// Steps up to which rows are delivered together, and up to which single rows of a jittering clock would follow one
/// another as often, in mean intervals.
const TOGETHER: f64 = 0.15;
const APART: f64 = 0.45;

/// Share of rows delivered together with the one before from which rows come in batches.
const DELIVERED: f64 = 0.004;

/// Least number of batches from which the clock is found.
const MIN_BATCHES: usize = 24;

/// Least mean number of rows in a batch.
const MIN_ROWS_PER_BATCH: f64 = 1.5;

/// Anchors on either side of a step that must agree on it, where their scatter is small and where it is not.
const CONFIRMING_ANCHORS: usize = 3;
const CONFIRMING_ANCHORS_SCATTERED: usize = 16;

/// Scatter of the anchors, in intervals, up to which few of them tell a step.
const SMALL_SCATTER: f64 = 0.1;

/// Lift of the line, in intervals, from which samples are missing.
const LIFT: f64 = 0.6;

/// Rows too many that a recording may hold, doubled ones.
const EXTRA: usize = 2;

/// Share of rows that may be earlier than the one before.
const FALLEN: f64 = 0.01;

/// Share of all samples that may be missing where the uniform clock is still the clear reading.
const MISSING: f64 = 0.4;

/// Anchors kept. Longer recordings are not read as batches.
const MAX_BATCHES: usize = 1 << 20;

/// The stamps that are compared with the uniform clock.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Anchor {
    /// Number of the row.
    row: f64,
    /// The stamp.
    stamp: f64,
    /// Number of the first row of the batch.
    batch: f64,
}

/// A batch: numbers and stamps of its first and last row.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Batch {
    first: StampedRow,
    last: StampedRow,
}

/// The row of a batch, and its stamp, that follow the sample clock most closely.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnchorRow {
    /// The first one by its own stamp: coarse stamps.
    First,
    /// The last one by its own stamp: the batch is written while it is sampled.
    Last,
    /// The last one by the stamp of the first one: delivery begins when the last sample is there, and takes its time.
    Delivery,
}

impl AnchorRow {
    const ALL: [AnchorRow; 3] = [AnchorRow::Last, AnchorRow::Delivery, AnchorRow::First];

    fn of(self, batch: &Batch) -> Anchor {
        let StampedRow { row, stamp } = match self {
            AnchorRow::First => batch.first,
            AnchorRow::Last => batch.last,
            AnchorRow::Delivery => StampedRow { row: batch.last.row, stamp: batch.first.stamp },
        };
        Anchor { row, stamp, batch: batch.first.row }
    }
}

/// Samples that are missing before a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// Number of the first row after them.
    pub row: u64,
    /// How many.
    pub samples: u64,
}

/// The uniform clock behind stamps in batches.
#[derive(Debug, Clone, PartialEq)]
pub struct Uniform {
    /// Its interval, s.
    pub interval_s: f64,
    /// The row of a batch that follows it.
    pub anchor: AnchorRow,
    /// Mean number of rows in a batch.
    pub rows: f64,
    /// Range of the deviations of the stamps from it, s.
    pub spread_s: f64,
    /// Where samples are missing, by rows from 0.
    pub losses: Vec<Loss>,
}

/// Collects the batches of a recording from its stamps.
#[derive(Debug, Clone)]
pub struct Batches {
    pause_s: f64,
    rows: u64,
    current: Option<Batch>,
    done: Vec<Batch>,
    fallen: u64,
}

impl Batches {
    /// Batches of a clock whose interval is known roughly, s.
    pub fn new(interval_s: f64) -> Batches {
        Batches { pause_s: PAUSE * interval_s, rows: 0, current: None, done: Vec::new(), fallen: 0 }
    }

    /// Takes the stamp of the next row.
    pub fn push(&mut self, stamp: f64) {
        let here = StampedRow { row: self.rows as f64, stamp };
        self.rows += 1;
        if !stamp.is_finite() {
            return;
        }
        let fresh = Batch { first: here, last: here };
        let Some(current) = self.current.as_mut() else {
            self.current = Some(fresh);
            return;
        };
        let step_s = stamp - current.last.stamp;
        if step_s < 0.0 {
            self.fallen += 1;
        } else if step_s > self.pause_s && self.done.len() < MAX_BATCHES {
            self.done.push(*current);
            *current = fresh;
        } else {
            current.last = here;
        }
    }

    /// True where there are batches enough for a clock.
    pub(super) fn enough(&self) -> bool {
        self.done.len() + 1 >= MIN_BATCHES
    }

    /// The uniform clock; `None` where the stamps do not tell it clearly.
    pub fn clock(mut self) -> Option<Uniform> {
        self.done.extend(self.current.take());
        let rows = self.rows as f64 / self.done.len().max(1) as f64;
        if self.done.len() < MIN_BATCHES
            || self.done.len() >= MAX_BATCHES
            || rows < MIN_ROWS_PER_BATCH
            || self.fallen as f64 > FALLEN * self.rows as f64
        {
            return None;
        }
        let (anchor, found) = AnchorRow::ALL
            .into_iter()
            .filter_map(|which| {
                let anchors: Vec<Anchor> = self.done.iter().map(|b| which.of(b)).collect();
                fit_with_losses(&anchors, which == AnchorRow::First).map(|s| (which, s))
            })
            .min_by(|a, b| a.1.rank().total_cmp(&b.1.rank()))?;
        let spread_s = spread(&self.done, &found);
        Some(Uniform { interval_s: found.interval_s, anchor, rows, spread_s, losses: found.losses })
    }
}

/// An interval with the losses that it leaves.
struct ClockWithLosses {
    interval_s: f64,
    losses: Vec<Loss>,
    scatter: f64,
}

impl ClockWithLosses {
    /// Fewer places at which samples are missing come first, then less scatter.
    fn rank(&self) -> f64 {
        self.losses.len() as f64 + self.scatter.min(0.99)
    }
}

/// Finds interval and losses in turns, from slopes over all distances. Of what is clear, the reading with the fewest
/// losses is taken: a rate near that of the batches needs a loss every few batches to explain the same stamps.
fn fit_with_losses(anchors: &[Anchor], early: bool) -> Option<ClockWithLosses> {
    let all = anchors.len() - 1;
    let lags = [all, all / 4, all / 16, CONFIRMING_ANCHORS_SCATTERED, CONFIRMING_ANCHORS_SCATTERED / 4, 1];
    let starts = lags
        .into_iter()
        .filter(|l| *l > 0)
        .flat_map(|lag| [(lag, CONFIRMING_ANCHORS), (lag, CONFIRMING_ANCHORS_SCATTERED)]);
    let tried = starts.filter_map(|(lag, reach)| fit_with_losses_from(anchors, early, lag, reach));
    tried.min_by(|a, b| a.rank().total_cmp(&b.rank()))
}

fn fit_with_losses_from(
    anchors: &[Anchor],
    early: bool,
    lag: usize,
    reach: usize,
) -> Option<ClockWithLosses> {
    let slopes = anchors.iter().zip(anchors.get(lag..)?).map(|(a, b)| (b.stamp - a.stamp) / (b.row - a.row));
    let mut interval_s = median(slopes.filter(|s| s.is_finite()).collect())?;
    let mut found = None;
    for _ in 0..4 {
        if !(interval_s.is_normal() && interval_s > 0.0) {
            return None;
        }
        let lifts = lifts(anchors, interval_s, early, reach)?;
        interval_s = slope(anchors, &lifts.lost)?;
        found = Some(lifts);
    }
    let lifts = found.filter(|s| s.clear)?;
    let rows = anchors.last()?.row - anchors.first()?.row;
    // A gap of any length is counted; what must be rare are the places.
    let short = lifts.losses.iter().map(|l| l.samples.min(8)).sum::<u64>() as f64;
    let places = if lifts.scatter <= SMALL_SCATTER { 0.5 } else { 0.1 };
    (lifts.losses.len() as f64 <= places * anchors.len() as f64 && short <= MISSING * rows)
        .then_some(ClockWithLosses { interval_s, losses: lifts.losses, scatter: lifts.scatter })
}

/// The slope of the line through all anchors, with what is lost between them.
fn slope(anchors: &[Anchor], lost: &[f64]) -> Option<f64> {
    let origin = anchors.first()?.stamp;
    let n = anchors.len() as f64;
    let points = || anchors.iter().zip(lost).map(|(a, l)| (a.row + l, a.stamp - origin));
    let (sx, sy) = points().fold((0.0, 0.0), |(x, y), p| (x + p.0, y + p.1));
    let (mx, my) = (sx / n, sy / n);
    let (xx, xy) =
        points().fold((0.0, 0.0), |(xx, xy), (x, y)| (xx + (x - mx) * (x - mx), xy + (x - mx) * (y - my)));
    Some(xy / xx).filter(|s| s.is_finite())
}

/// Where the line of the anchors is lifted.
struct Lifts {
    /// Samples missing before each anchor, in all.
    lost: Vec<f64>,
    losses: Vec<Loss>,
    /// Scatter of the anchors, in intervals.
    scatter: f64,
    /// Every change of the line is one of whole samples, upwards.
    clear: bool,
}

/// Follows the edge at which the delays end sharply: the least delay, or of coarse stamps, which are early, the least
/// advance. These are followed from the end to the beginning with the sign turned, where a loss lifts them likewise.
fn lifts(anchors: &[Anchor], interval_s: f64, early: bool, reach: usize) -> Option<Lifts> {
    let start = anchors.first()?;
    let mut off: Vec<f64> =
        anchors.iter().map(|a| (a.stamp - start.stamp) / interval_s - (a.row - start.row)).collect();
    if early {
        off.reverse();
        off.iter_mut().for_each(|v| *v = -*v);
    }
    let near = off.iter().zip(off.get(1..)?).map(|(a, b)| (b - a).abs()).collect();
    let scatter = median(near)?;
    if scatter > SMALL_SCATTER && reach == CONFIRMING_ANCHORS {
        return None;
    }
    let edge = |w: &[f64]| w.iter().copied().fold(f64::MAX, f64::min);
    let n = off.len();
    let (mut at, mut changes, mut fell, mut taken) = (vec![0.0; n], Vec::new(), 0, 0.0);
    for j in 1..n {
        let (from, to) = (j.saturating_sub(reach), (j + reach).min(n));
        // Samples lost before are taken from the anchors behind, which are not changed.
        let (before, after) = (off.get(from..j)?, off.get(j..to)?);
        let step = edge(after) - taken - edge(before);
        let full = from + reach == j && j + reach == to;
        // Near the ends few anchors are on one side, and their scatter is no evidence of a small step.
        let least = if scatter > SMALL_SCATTER && !full { 1.6 } else { LIFT };
        if step >= least && median(after.to_vec())? - taken - median(before.to_vec())? >= LIFT {
            let samples = step.round().max(1.0);
            taken += samples;
            let forward = if early { n - j } else { j };
            *at.get_mut(forward)? = samples;
            changes.push((step - samples).abs());
        } else if full {
            let whole = if step <= -LIFT { step.round().min(-1.0) } else { 0.0 };
            // A row too many: the rows after it are taken as they follow.
            taken += whole;
            fell += usize::from(
                whole < 0.0 && from > CONFIRMING_ANCHORS_SCATTERED && to + CONFIRMING_ANCHORS_SCATTERED < n,
            );
            changes.push((step - whole).abs());
        }
        *off.get_mut(j)? -= taken;
    }
    changes.sort_by(f64::total_cmp);
    let share = |p: f64| changes.get(((changes.len() as f64 - 1.0) * p) as usize).copied();
    let clear = fell <= EXTRA && share(0.5)? <= 0.15 && share(0.98)? <= 0.4;
    let (mut total, mut losses) = (0.0, Vec::new());
    for (samples, anchor) in at.iter_mut().zip(anchors) {
        if *samples > 0.0 {
            losses.push(Loss { row: anchor.batch as u64, samples: *samples as u64 });
        }
        total += *samples;
        *samples = total;
    }
    Some(Lifts { lost: at, losses, scatter, clear })
}

/// How far the stamps of the batches reach from the uniform clock, s.
fn spread(batches: &[Batch], found: &ClockWithLosses) -> f64 {
    let mut losses = found.losses.iter().peekable();
    let (mut low, mut high, mut lost) = (f64::MAX, f64::MIN, 0.0);
    let origin = batches.first().map_or(0.0, |b| b.first.stamp);
    for batch in batches {
        while let Some(loss) = losses.next_if(|l| l.row as f64 <= batch.first.row) {
            lost += loss.samples as f64;
        }
        for StampedRow { row, stamp } in [batch.first, batch.last] {
            let off = stamp - origin - (row + lost) * found.interval_s;
            (low, high) = (low.min(off), high.max(off));
        }
    }
    (high - low).max(0.0)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Stamps of a recording beside a uniform clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Course {
    /// The mean interval, from stretches that are unbroken.
    pub mean_s: f64,
    /// The middle step, in mean intervals.
    pub middle: f64,
    /// The departure from a uniform clock does not grow with the distance.
    pub bounded: bool,
}

/// Looks at stamps, all finite.
pub(super) fn course(t: &[f64]) -> Option<Course> {
    let length = (t.len() / 64).clamp(64.min(t.len()), 4096).max(2);
    let means = t.chunks_exact(length).filter_map(|w| Some((w.last()? - w.first()?) / (w.len() - 1) as f64));
    let mean_s = median(means.filter(|m| *m > 0.0).collect())?;
    let middle = median(steps(t).collect())? / mean_s;
    let range = |lag: usize| {
        let mut d: Vec<f64> = t.iter().zip(t.get(lag..)?).map(|(a, b)| b - a).collect();
        d.sort_by(f64::total_cmp);
        let last = d.len().checked_sub(1)? as f64;
        let at = |p: f64| d.get((last * p) as usize).copied();
        Some(at(0.9)? - at(0.1)?)
    };
    let near = (t.len() / 64).clamp(1, 64);
    let (short, long) = (range(near)?, range(16 * near)?);
    Some(Course { mean_s, middle, bounded: t.len() >= 1024 && long <= 2.0 * short.max(0.5 * mean_s) })
}

/// True when the middle step is so short that the rows come in batches, if they come from a uniform clock.
pub(super) fn in_batches(course: &Course) -> bool {
    course.middle <= WITHIN
}

/// True where most batches have one row and some have more: their short steps stand apart from the others and make up for
/// the wait before them. Rows that were written twice make up for nothing.
pub(super) fn occasional_batches(t: &[f64], course: &Course) -> bool {
    let (mut together, mut apart, mut made_up) = (0usize, 0usize, 0usize);
    // The wait before the rows that are delivered now, and how many they are, in mean intervals.
    let (mut wait, mut rows) = (1.0, 1.0);
    for step in steps(t).map(|d| d / course.mean_s) {
        if (0.0..TOGETHER).contains(&step) {
            (together, rows) = (together + 1, rows + 1.0);
            made_up += usize::from(wait >= rows - 0.6);
        } else {
            apart += usize::from((TOGETHER..APART).contains(&step));
            (wait, rows) = (step, 1.0);
        }
    }
    together as f64 >= DELIVERED * t.len() as f64 && 3 * apart < together && 10 * made_up >= 8 * together
}
