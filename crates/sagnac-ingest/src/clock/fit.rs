//! The interval of a clock by regression of its stamps on the number of the sample, in one pass and bounded memory.
//!
//! Stamps are summed in segments, each about its own first stamp, so that no digits are lost. Segments of one stretch are
//! merged exactly; what the segments show one by one gives the drift of the clock, and the uncertainty of the interval
//! where the clock wanders.

/// Segments kept; neighbours are merged beyond.
const SEGMENTS: usize = 128;

/// Rows of a segment at first.
const SHORTEST: u64 = 1024;

/// Segments from which their scatter tells the uncertainty of the interval.
const ENOUGH: usize = 8;

/// Sums over a run of stamps about its first one: x counts samples, r = stamp − first − x·nominal.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Sums {
    stretch: u32,
    x0: f64,
    t0: f64,
    n: f64,
    x: f64,
    xx: f64,
    r: f64,
    xr: f64,
    rr: f64,
}

impl Sums {
    /// The sums of both, about the first stamp of `self`.
    fn merged(self, other: Sums, nominal: f64) -> Sums {
        let dx = other.x0 - self.x0;
        let dr = other.t0 - self.t0 - dx * nominal;
        Sums {
            n: self.n + other.n,
            x: self.x + other.x + other.n * dx,
            xx: self.xx + other.xx + 2.0 * dx * other.x + other.n * dx * dx,
            r: self.r + other.r + other.n * dr,
            xr: self.xr + other.xr + dx * other.r + dr * other.x + other.n * dx * dr,
            rr: self.rr + other.rr + 2.0 * dr * other.r + other.n * dr * dr,
            ..self
        }
    }

    /// Sums about the mean: of x·x, of x·r, of r·r.
    fn centred(&self) -> (f64, f64, f64) {
        let n = self.n.max(1.0);
        (self.xx - self.x * self.x / n, self.xr - self.x * self.r / n, self.rr - self.r * self.r / n)
    }
}

/// Sample interval measured by regression of the stamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Mean sample interval, s.
    pub interval_s: f64,
    /// Its standard uncertainty from the scatter of the stamps about a uniform clock, s; what the clock itself is off
    /// by against true time is not in it.
    pub uncertainty_s: f64,
    /// Rms departure of the stamps from a uniform clock, s.
    pub residual_s: f64,
    /// Change of the interval from the beginning to the end, relative, where there are segments enough to tell.
    pub drift: Option<f64>,
    /// Standard uncertainty of the change.
    pub drift_uncertainty: Option<f64>,
}

/// Regression of stamps on sample numbers.
#[derive(Debug, Clone)]
pub struct Fit {
    nominal: f64,
    done: Vec<Sums>,
    /// Sums about the means of stretches that are no longer kept one by one, and their number of stamps.
    folded: (f64, f64, f64, f64),
    folded_stretches: u64,
    current: Sums,
    segment_rows: u64,
}

impl Fit {
    /// Starts with the nominal interval, s.
    pub fn new(nominal_s: f64) -> Fit {
        Fit {
            nominal: nominal_s,
            done: Vec::new(),
            folded: (0.0, 0.0, 0.0, 0.0),
            folded_stretches: 0,
            current: Sums::default(),
            segment_rows: SHORTEST,
        }
    }

    /// Adds a stamp, `samples` after the one before; the first of a stretch takes any number.
    pub fn add(&mut self, stamp: f64, x: f64) {
        if self.current.n as u64 >= self.segment_rows {
            self.close(x, stamp);
        }
        let c = &mut self.current;
        if c.n == 0.0 {
            (c.x0, c.t0) = (x, stamp);
        }
        let x = x - c.x0;
        let r = stamp - c.t0 - x * self.nominal;
        c.n += 1.0;
        c.x += x;
        c.xx += x * x;
        c.r += r;
        c.xr += x * r;
        c.rr += r * r;
    }

    /// Adds consecutive stamps, the first one at sample `x`.
    pub fn add_block(&mut self, stamps: &[f64], x: f64) {
        let mut done = 0;
        while let Some(rest) = stamps.get(done..).filter(|r| !r.is_empty()) {
            let at = x + done as f64;
            if self.current.n as u64 >= self.segment_rows {
                self.close(at, rest.first().copied().unwrap_or(0.0));
            }
            let room = (self.segment_rows as f64 - self.current.n).max(1.0) as usize;
            let part = rest.get(..room.min(rest.len())).unwrap_or(rest);
            let sums = block_sums(part, at, self.nominal, self.current.stretch);
            self.current = if self.current.n == 0.0 { sums } else { self.current.merged(sums, self.nominal) };
            done += part.len();
        }
    }

    /// The next stamp starts a stretch: how it stands to the ones before is not known.
    pub fn break_off(&mut self) {
        if self.current.n > 0.0 {
            let stretch = self.current.stretch.wrapping_add(1);
            self.push();
            self.current = Sums { stretch, ..Sums::default() };
        }
    }

    fn close(&mut self, x: f64, stamp: f64) {
        let stretch = self.current.stretch;
        self.push();
        self.current = Sums { stretch, x0: x, t0: stamp, ..Sums::default() };
    }

    fn push(&mut self) {
        self.done.push(self.current);
        if self.done.len() < SEGMENTS {
            return;
        }
        let mut merged: Vec<Sums> = Vec::with_capacity(SEGMENTS);
        let mut i = 0;
        while let Some(&one) = self.done.get(i) {
            match self.done.get(i + 1).filter(|two| two.stretch == one.stretch) {
                Some(&two) => {
                    merged.push(one.merged(two, self.nominal));
                    i += 2;
                }
                None => {
                    merged.push(one);
                    i += 1;
                }
            }
        }
        self.segment_rows = self.segment_rows.saturating_mul(2);
        // Many short stretches: the oldest are kept as sums only.
        if merged.len() > SEGMENTS / 2 {
            let rest = merged.split_off(merged.len() / 2);
            for (_, sums) in by_stretch(&merged, self.nominal) {
                let (xx, xr, rr) = sums.centred();
                let f = &mut self.folded;
                *f = (f.0 + xx, f.1 + xr, f.2 + rr, f.3 + sums.n);
                self.folded_stretches += 1;
            }
            merged = rest;
        }
        self.done = merged;
    }

    /// The fitted clock; `None` with fewer than two stamps in every stretch.
    pub fn measured(&self) -> Option<Measured> {
        let mut all = self.done.clone();
        if self.current.n > 0.0 {
            all.push(self.current);
        }
        let (mut xx, mut xr, mut rr, mut n) = self.folded;
        let stretches = by_stretch(&all, self.nominal);
        for (_, sums) in &stretches {
            let (a, b, c) = sums.centred();
            (xx, xr, rr, n) = (xx + a, xr + b, rr + c, n + sums.n);
        }
        if xx <= 0.0 || !(xx.is_finite() && xr.is_finite()) {
            return None;
        }
        let slope = xr / xx;
        let free = n - 1.0 - stretches.len() as f64 - self.folded_stretches as f64;
        let left = (rr - slope * xr).max(0.0);
        let white = if free > 0.0 { (left / free / xx).sqrt() } else { 0.0 };
        let (scatter, trend) = self.segments(&all, if free > 0.0 { left / free } else { 0.0 });
        Some(Measured {
            interval_s: self.nominal + slope,
            uncertainty_s: white.hypot(scatter.unwrap_or(0.0)),
            residual_s: (left / n).sqrt(),
            drift: trend.map(|t| t.0),
            drift_uncertainty: trend.map(|t| t.1),
        })
    }

    /// Uncertainty of the mean of the segments' slopes by what they scatter beyond white jitter of that variance, and the
    /// trend over the record with its uncertainty.
    fn segments(&self, all: &[Sums], variance: f64) -> (Option<f64>, Option<(f64, f64)>) {
        let full = all.iter().filter(|s| s.n >= 0.75 * self.segment_rows as f64 && s.n >= 16.0);
        let mut white = 0.0;
        let slopes: Vec<(f64, f64)> = full
            .filter_map(|s| {
                let (xx, xr, _) = s.centred();
                white += variance / xx.max(f64::MIN_POSITIVE);
                (xx > 0.0).then(|| (s.x0 + s.x / s.n, xr / xx))
            })
            .collect();
        if slopes.len() < ENOUGH {
            return (None, None);
        }
        let n = slopes.len() as f64;
        let mean_x = slopes.iter().map(|s| s.0).sum::<f64>() / n;
        let mean = slopes.iter().map(|s| s.1).sum::<f64>() / n;
        let xx: f64 = slopes.iter().map(|s| (s.0 - mean_x).powi(2)).sum();
        let xy: f64 = slopes.iter().map(|s| (s.0 - mean_x) * (s.1 - mean)).sum();
        if xx <= 0.0 {
            return (None, None);
        }
        let trend = xy / xx;
        let left: f64 = slopes.iter().map(|s| (s.1 - mean - trend * (s.0 - mean_x)).powi(2)).sum();
        let deviation = (left / (n - 2.0)).sqrt();
        let (first, last) = (slopes.first().map_or(0.0, |s| s.0), slopes.last().map_or(0.0, |s| s.0));
        let span = (last - first) * n / (n - 1.0);
        let interval = self.nominal + mean;
        // The scatter of n slopes is itself uncertain by the root of 2/n.
        let beyond = (deviation * deviation - white / n * (1.0 + 2.0 * (2.0 / n).sqrt())).max(0.0);
        (Some((beyond / n).sqrt()), Some((trend * span / interval, deviation / xx.sqrt() * span / interval)))
    }
}

fn by_stretch(all: &[Sums], nominal: f64) -> Vec<(u32, Sums)> {
    let mut out: Vec<(u32, Sums)> = Vec::new();
    for &sums in all {
        match out.last_mut().filter(|(stretch, _)| *stretch == sums.stretch) {
            Some((_, merged)) => *merged = merged.merged(sums, nominal),
            None => out.push((sums.stretch, sums)),
        }
    }
    out
}

/// Sums over consecutive stamps; four at a time, so that one addition need not wait for another.
fn block_sums(stamps: &[f64], x0: f64, nominal: f64, stretch: u32) -> Sums {
    let t0 = stamps.first().copied().unwrap_or(0.0);
    let (mut r, mut xr, mut rr) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    let mut x = [0.0, 1.0, 2.0, 3.0];
    let chunks = stamps.chunks_exact(4);
    let rest = chunks.remainder();
    for chunk in chunks {
        for ((((t, x), r), xr), rr) in chunk.iter().zip(&mut x).zip(&mut r).zip(&mut xr).zip(&mut rr) {
            let d = t - t0 - *x * nominal;
            *r += d;
            *xr += *x * d;
            *rr += d * d;
            *x += 4.0;
        }
    }
    for (t, x) in rest.iter().zip(&x) {
        let d = t - t0 - x * nominal;
        r[0] += d;
        xr[0] += x * d;
        rr[0] += d * d;
    }
    let n = stamps.len() as f64;
    Sums {
        stretch,
        x0,
        t0,
        n,
        x: 0.5 * n * (n - 1.0),
        xx: n * (n - 1.0) * (2.0 * n - 1.0) / 6.0,
        r: r.iter().sum(),
        xr: xr.iter().sum(),
        rr: rr.iter().sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least squares in one go, for comparison.
    fn plain(t: &[f64]) -> f64 {
        let n = t.len() as f64;
        let (mx, mt) = ((n - 1.0) / 2.0, t.iter().sum::<f64>() / n);
        let (mut a, mut b) = (0.0, 0.0);
        for (i, t) in t.iter().enumerate() {
            let x = i as f64 - mx;
            a += x * x;
            b += x * (t - mt);
        }
        b / a
    }

    #[test]
    fn blocks_segments_and_single_stamps_give_least_squares() {
        let t: Vec<f64> =
            (0..300_007).map(|i| 0.01 * f64::from(i) + 1e-3 * (f64::from(i) * 0.7).sin()).collect();
        let expected = plain(&t);
        let (mut a, mut b) = (Fit::new(0.0101), Fit::new(0.0101));
        t.iter().enumerate().for_each(|(i, t)| a.add(*t, i as f64));
        for (i, part) in t.chunks(4099).enumerate() {
            b.add_block(part, (i * 4099) as f64);
        }
        for fit in [a, b] {
            let m = fit.measured().unwrap();
            assert!((m.interval_s / expected - 1.0).abs() < 1e-12, "{m:?} {expected}");
            assert!((m.residual_s - 1e-3 / 2f64.sqrt()).abs() < 1e-5, "{m:?}");
        }
    }

    #[test]
    fn stretches_have_one_slope_and_starts_of_their_own() {
        let mut fit = Fit::new(1.0);
        for stretch in 0..500 {
            for i in 0..20 {
                fit.add(f64::from(stretch) * 1234.5 + 1.25 * f64::from(i), f64::from(stretch * 100 + i));
            }
            fit.break_off();
        }
        let m = fit.measured().unwrap();
        assert!((m.interval_s - 1.25).abs() < 1e-12 && m.residual_s < 1e-5, "{m:?}");
    }

    #[test]
    fn drift_is_the_change_of_the_interval() {
        let mut fit = Fit::new(0.01);
        // The interval grows by 20 ppm from the first sample to the last.
        let n = 200_000;
        for i in 0..n {
            let x = f64::from(i);
            fit.add(0.01 * (x + 0.5 * 20e-6 * x * x / f64::from(n)), x);
        }
        let m = fit.measured().unwrap();
        assert!((m.drift.unwrap() / 20e-6 - 1.0).abs() < 1e-2, "{m:?}");
        assert!((m.interval_s / (0.01 * (1.0 + 10e-6)) - 1.0).abs() < 1e-8, "{m:?}");
    }
}
