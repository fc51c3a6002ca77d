//! The quantization grid that values lie on: value = k·step + offset with whole k, within the error of a double.
//!
//! The step is the common divisor of the differences of the first values, found by Euclid's algorithm with a tolerance;
//! every later value is checked against it and makes it smaller where needed. A step that is no short decimal, such as 30/256,
//! leaves values that were rounded once more, to the decimals of the file: they lie on the grid of the decimals and, within one of
//! these, on that of the step.

/// Values from which the step is first found.
const FIRST_SAMPLES: usize = 4096;
/// Smallest step in units of the error of the values: below, a quantization grid cannot be told from rounding.
const MIN_STEP_ERRORS: f64 = 1e4;
/// Largest deviation from the quantization grid, steps.
const OFF: f64 = 0.02;

/// Decimals that a step holds at least for its grid to be told from theirs.
const MIN_DECIMALS: f64 = 8.0;
/// Distance from the grid that values rounded to decimals have, decimals: half of one for each of two values, and a margin.
const ROUNDED_OFF: f64 = 1.5;
/// Probability that values without such a step lie on its grid.
const CHANCE: f64 = 1e-6;
/// Samples for each different value from which few values are a grid by themselves.
const MANY_PER_LEVEL: usize = 50;

/// A grid whose values were rounded to a finer one.
#[derive(Debug, Clone, Copy)]
struct RoundedGrid {
    origin: f64,
    step: f64,
    /// Largest distance from the grid.
    slack: f64,
    /// Error of the step.
    error: f64,
}

impl RoundedGrid {
    /// The grid of different values, ascending, of so many samples on a grid of decimals.
    fn of(levels: &[f64], decimal: f64, samples: usize) -> Option<RoundedGrid> {
        let (origin, last) = (*levels.first()?, *levels.last()?);
        let gaps = levels.iter().zip(levels.get(1..)?).map(|(a, b)| b - a);
        let smallest = gaps.fold(f64::INFINITY, f64::min);
        if smallest < MIN_DECIMALS * decimal {
            return None;
        }
        let slack = ROUNDED_OFF * decimal;
        let mut grid = RoundedGrid { origin, step: smallest, slack, error: decimal };
        for value in levels.get(1..)? {
            let steps = ((value - origin) / grid.step).round();
            if !grid.holds(*value) {
                return None;
            }
            if decimal / steps < grid.error {
                (grid.step, grid.error) = ((value - origin) / steps, decimal / steps);
            }
        }
        let by_chance = (2.0 * slack / grid.step).powi(levels.len() as i32 - 2);
        let told = by_chance < CHANCE || levels.len() * MANY_PER_LEVEL <= samples;
        (told && last > origin && levels.iter().all(|v| grid.holds(*v))).then_some(grid)
    }

    fn holds(&self, value: f64) -> bool {
        let steps = ((value - self.origin) / self.step).round();
        (value - self.origin - steps * self.step).abs() <= self.slack + steps.abs() * self.error
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct QuantizationGrid {
    first: Vec<f64>,
    origin: f64,
    step: f64,
    /// Error of the step.
    error: f64,
    /// Largest distance from the origin so far.
    reach: f64,
    largest: f64,
    state: State,
    rounded: Option<RoundedGrid>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum State {
    #[default]
    Gathering,
    Checking,
    None,
}

impl QuantizationGrid {
    pub(super) fn take(&mut self, mut values: &[f64]) {
        while self.state == State::Gathering && !values.is_empty() {
            let room = FIRST_SAMPLES - self.first.len().min(FIRST_SAMPLES);
            let (head, rest) = values.split_at(values.len().min(room));
            self.first.extend_from_slice(head);
            values = rest;
            if self.first.len() >= FIRST_SAMPLES {
                self.find();
            }
        }
        if self.state == State::Checking && !values.is_empty() {
            self.check(values);
            self.rounded = self.rounded.filter(|grid| values.iter().all(|v| grid.holds(*v)));
        }
    }

    /// The step, when all values lie on a quantization grid.
    pub(super) fn step(&self) -> Option<f64> {
        let mut done = self.clone();
        if done.state == State::Gathering {
            done.find();
        }
        let step = done.rounded.map_or(done.step, |grid| grid.step);
        (done.state == State::Checking && step > 0.0).then_some(step)
    }

    fn find(&mut self) {
        let mut sorted = std::mem::take(&mut self.first);
        let samples = sorted.len();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted.dedup();
        let (Some(&low), Some(&high)) = (sorted.first(), sorted.last()) else { return };
        if sorted.len() < 2 {
            // An output that stands still tells its step only where it moves.
            self.first = sorted;
            return;
        }
        self.state = State::None;
        self.origin = low;
        self.largest = low.abs().max(high.abs());
        let mut gaps: Vec<f64> = sorted.iter().zip(sorted.iter().skip(1)).map(|(a, b)| b - a).collect();
        // From the smallest on, so that the step is known ever better before it is multiplied by large numbers.
        gaps.sort_unstable_by(f64::total_cmp);
        self.step = gaps.first().copied().unwrap_or(0.0);
        self.error = self.rounding();
        for gap in gaps {
            if !self.fit(gap) {
                return;
            }
        }
        self.state = State::Checking;
        self.fit(high - low);
        self.reach = high - low;
        self.check(&sorted);
        self.rounded = RoundedGrid::of(&sorted, self.step, samples);
    }

    /// Error of a difference of two values.
    fn rounding(&self) -> f64 {
        4.0 * f64::EPSILON * self.largest
    }

    /// Makes the step divide a length, and refines it by the length where it does; false when no step is left.
    fn fit(&mut self, length: f64) -> bool {
        if self.step < MIN_STEP_ERRORS * f64::EPSILON * self.largest {
            return false;
        }
        let k = (length / self.step).round();
        let allowed = self.rounding() + 2.0 * k * self.error;
        let off = (length - k * self.step).abs();
        if off <= allowed.min(OFF * self.step) {
            if self.rounding() < k * self.error {
                self.step = length / k;
                self.error = self.rounding() / k;
            }
            return true;
        }
        self.step = divisor(self.step, off, allowed);
        self.error = allowed;
        self.step >= MIN_STEP_ERRORS * f64::EPSILON * self.largest
    }

    fn check(&mut self, values: &[f64]) {
        let (origin, inverse) = (self.origin, 1.0 / self.step);
        let (mut worst, mut reach) = (0.0f64, 0.0f64);
        for &v in values {
            let d = v - origin;
            let k = d * inverse;
            let off = (k - nearest(k)).abs();
            worst = if off > worst { off } else { worst };
            reach = if d.abs() > reach { d.abs() } else { reach };
        }
        if worst <= OFF && reach <= 2.0 * self.reach {
            return;
        }
        for &v in values {
            self.largest = self.largest.max(v.abs());
            let distance = (v - self.origin).abs();
            let off = (distance / self.step - (distance / self.step).round()).abs();
            if (off > OFF || distance > 2.0 * self.reach) && !self.fit(distance) {
                self.state = State::None;
                return;
            }
            self.reach = self.reach.max(distance);
        }
    }
}

/// The nearest whole number, for numbers below 2^51: adding and taking away 1.5·2^52 rounds, without a call.
#[inline(always)]
fn nearest(k: f64) -> f64 {
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    (k + SHIFT) - SHIFT
}

/// Greatest common divisor of two lengths, each known within a tolerance; small when there is none.
fn divisor(a: f64, b: f64, tolerance: f64) -> f64 {
    let (mut a, mut b, mut tolerance) = (a.max(b), a.min(b), tolerance);
    while b > tolerance {
        let k = (a / b).round();
        (a, b) = (b, (a - k * b).abs());
        tolerance *= k.max(1.0);
    }
    a
}
