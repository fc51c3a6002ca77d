//! Small statistics that are taken beside the noise while a recording goes by.

/// The angle that a rate adds up to, deg: at the end, least and greatest. The bias is part of it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Angle {
    pub end_deg: f64,
    pub min_deg: f64,
    pub max_deg: f64,
}

impl Angle {
    pub fn push(&mut self, rates_deg_h: &[f64], tau0_s: f64) {
        for rate in rates_deg_h.iter().filter(|r| r.is_finite()) {
            self.end_deg += rate * tau0_s / 3600.0;
            self.min_deg = self.min_deg.min(self.end_deg);
            self.max_deg = self.max_deg.max(self.end_deg);
        }
    }
}

/// Values that are kept of a track at most, evenly over the record.
const MAX_KEPT: usize = 1 << 16;

/// The values that a driven quantity (a table rate) was held at.
#[derive(Debug, Clone, Default)]
pub(super) struct LevelFinder {
    /// Value and distance from the one before it in the record.
    kept: Vec<(f64, f64)>,
    stride: u64,
    found: u64,
    before: Option<f64>,
}

/// What a driven quantity did.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HeldLevels {
    pub min: f64,
    pub max: f64,
    /// Levels at which it was held, ascending; empty when it was held for less than half of the record.
    pub levels: Vec<f64>,
}

impl LevelFinder {
    pub fn push(&mut self, values: &[f64]) {
        self.stride = self.stride.max(1);
        for &v in values.iter().filter(|v| v.is_finite()) {
            if self.found.is_multiple_of(self.stride) {
                self.kept.push((v, self.before.map_or(0.0, |b| (v - b).abs())));
            }
            self.found += 1;
            self.before = Some(v);
            if self.kept.len() > MAX_KEPT {
                let mut index = 0;
                self.kept.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.stride *= 2;
            }
        }
    }

    /// `every_row_counts`: each row is a step of its own, as in a table of means; else only rows at which the value
    /// hardly changes belong to a level.
    pub fn finish(&self, every_row_counts: bool) -> Option<HeldLevels> {
        let min = self.kept.iter().map(|k| k.0).reduce(f64::min)?;
        let max = self.kept.iter().map(|k| k.0).reduce(f64::max)?;
        let range = max - min;
        let mut held: Vec<f64> = self
            .kept
            .iter()
            .filter(|(_, step)| every_row_counts || *step <= range / 5000.0)
            .map(|k| k.0)
            .collect();
        held.sort_by(f64::total_cmp);
        let mut levels = Vec::new();
        if 2 * held.len() >= self.kept.len() {
            for group in held.chunk_by(|a, b| b - a <= range / 1000.0) {
                levels.push(group.iter().sum::<f64>() / group.len() as f64);
            }
        }
        Some(HeldLevels { min, max, levels })
    }
}

/// Correlation and straight line of a column against a driven quantity.
#[derive(Debug, Clone, Default)]
pub(super) struct LinearFit {
    origin: Option<(f64, f64)>,
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl LinearFit {
    pub fn push(&mut self, driver: &[f64], column: &[f64]) {
        for (&x, &y) in driver.iter().zip(column).filter(|(x, y)| x.is_finite() && y.is_finite()) {
            let origin = *self.origin.get_or_insert((x, y));
            let (x, y) = (x - origin.0, y - origin.1);
            self.n += 1.0;
            self.x += x;
            self.y += y;
            self.xx += x * x;
            self.xy += x * y;
            self.yy += y * y;
        }
    }

    /// Correlation and slope; `None` when one of the two does not vary.
    pub fn finish(&self) -> Option<(f64, f64)> {
        let xx = self.n * self.xx - self.x * self.x;
        let yy = self.n * self.yy - self.y * self.y;
        let xy = self.n * self.xy - self.x * self.y;
        let usable = self.n >= 3.0 && xx > 0.0 && yy > 0.0;
        usable.then(|| (xy / (xx * yy).sqrt(), xy / xx))
    }
}

/// Runs up and runs down of a slow quantity, where a turn counts when it goes back by a quarter of the range.
pub(super) fn runs(means: &[f64]) -> (u32, u32) {
    let finite = || means.iter().copied().filter(|m| m.is_finite());
    let (Some(min), Some(max)) = (finite().reduce(f64::min), finite().reduce(f64::max)) else {
        return (0, 0);
    };
    let turn = 0.25 * (max - min);
    let (mut low, mut high, mut direction) = (f64::INFINITY, f64::NEG_INFINITY, 0);
    let (mut up, mut down) = (0, 0);
    for m in finite() {
        low = low.min(m);
        high = high.max(m);
        if direction <= 0 && m - low > turn {
            (up, direction, high) = (up + 1, 1, m);
        } else if direction >= 0 && high - m > turn {
            (down, direction, low) = (down + 1, -1, m);
        }
    }
    (up, down)
}
