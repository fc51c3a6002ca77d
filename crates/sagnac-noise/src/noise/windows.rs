//! Means over consecutive windows and their standard deviation: the Russian σ of 100-s and 10-s averages.
//!
//! No normative text fixes the details; here: non-overlapping windows from the start of each unbroken stretch, the
//! remainder dropped, mean removed only, n − 1 in the denominator.

use super::part::{Head, MergeError};

/// Window means kept one by one; beyond, only their moments.
pub const MAX_KEPT_MEANS: usize = 1_000_000;

/// What the windows gave.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowStatistics {
    /// Window length asked for, s.
    pub window_s: f64,
    /// Samples in a window.
    pub samples: u64,
    /// Windows that are complete.
    pub n: u64,
    /// Mean of the window means, deg/h; NaN without any.
    pub mean: f64,
    /// Standard deviation of the window means with n − 1, deg/h; NaN below two windows.
    pub standard_deviation: f64,
    /// The means in order, deg/h, `None` when there were more than [`MAX_KEPT_MEANS`].
    pub means: Option<Vec<f64>>,
    /// Number of means in each unbroken stretch that has any, in order; the last entries are missing when the means are.
    pub per_stretch: Vec<u64>,
}

/// Largest relative difference of a window of whole samples from the one asked for: 1 % in a standard deviation.
const MAX_LENGTH_ERROR: f64 = 0.02;

impl WindowStatistics {
    /// What the windows hold, s.
    pub fn exact_s(&self, tau0_s: f64) -> f64 {
        self.samples as f64 * tau0_s
    }

    /// Whether whole samples make the window that was asked for. A figure of other windows is another figure.
    pub fn fits(&self, tau0_s: f64) -> bool {
        (self.exact_s(tau0_s) / self.window_s - 1.0).abs() <= MAX_LENGTH_ERROR
    }
}

/// Streaming window means of one length.
#[derive(Debug, Clone)]
pub struct WindowMeans {
    head: Head,
    window_s: f64,
    samples: u64,
    /// Samples of the open window, those before the part included.
    filled: u64,
    /// Samples of the open window that are in `sum`.
    summed: u64,
    /// Addition of a part to the window that was open before it.
    lead: Option<Lead>,
    /// Whether the open window was open before the part.
    leading: bool,
    /// Windows of the stretch that the part continues, where that has ended.
    in_first: Option<u64>,
    /// First sample of the window.
    reference: f64,
    sum: f64,
    n: u64,
    /// First sample of all: moments are taken about it, so that a large offset costs no digits.
    origin: Option<f64>,
    mean: f64,
    squares: f64,
    means: Vec<f64>,
    per_stretch: Vec<u64>,
    in_stretch: u64,
}

/// Sum of samples of one window about a reference.
#[derive(Debug, Clone, Copy)]
struct Lead {
    reference: f64,
    sum: f64,
    count: u64,
}

impl WindowMeans {
    /// Windows of `window_s` seconds, rounded to whole samples of `tau0_s` seconds (at least one).
    pub fn new(window_s: f64, tau0_s: f64) -> Self {
        let samples = (window_s / tau0_s).round().max(1.0) as u64;
        WindowMeans {
            head: Head::default(),
            window_s,
            samples,
            filled: 0,
            summed: 0,
            lead: None,
            leading: false,
            in_first: None,
            reference: 0.0,
            sum: 0.0,
            n: 0,
            origin: None,
            mean: 0.0,
            squares: 0.0,
            means: vec![],
            per_stretch: vec![],
            in_stretch: 0,
        }
    }

    /// The accumulator of a part with `samples_before` samples of its stretch before it.
    pub fn of_part(window_s: f64, tau0_s: f64, samples_before: u64) -> Self {
        let mut part = Self::new(window_s, tau0_s);
        part.head = Head::new(samples_before, 0);
        part.filled = samples_before % part.samples;
        part.leading = part.filled > 0;
        part
    }

    /// Takes finite contiguous samples; `continues` as everywhere: false starts a new stretch and a new window.
    pub fn push(&mut self, samples: &[f64], continues: bool) {
        if !continues {
            self.end_stretch();
        }
        self.head.take(samples, continues);
        let mut rest = samples;
        while let Some(first) = rest.first() {
            if self.summed == 0 {
                self.reference = *first;
                self.sum = 0.0;
            }
            let room = self.samples - self.filled;
            let (now, later) = rest.split_at(usize::try_from(room).unwrap_or(usize::MAX).min(rest.len()));
            // Blocks keep the rounding of a long plain sum away.
            for block in now.chunks(1024) {
                self.sum += block.iter().map(|y| y - self.reference).sum::<f64>();
            }
            self.filled += now.len() as u64;
            self.summed += now.len() as u64;
            self.close_full();
            rest = later;
        }
    }

    /// Adds the next part of the recording. Windows are those of one pass, their moments agree to rounding.
    ///
    /// # Errors
    /// Where the part begins elsewhere than this one ends, or has other windows.
    pub fn merge(&mut self, later: WindowMeans) -> Result<(), MergeError> {
        if later.head.is_empty() {
            return Ok(());
        }
        self.head.accepts(&later.head)?;
        if self.samples != later.samples {
            return Err(MergeError::Settings);
        }
        if self.head.is_empty() && later.head.begun().is_some() {
            *self = later;
            return Ok(());
        }
        if later.head.begun().is_some() {
            let open = Lead { reference: later.reference, sum: later.sum, count: later.summed };
            let lead = later.lead.or(later.leading.then_some(open));
            if let Some(Lead { reference, sum, count }) = lead {
                self.sum += sum + count as f64 * (reference - self.reference);
                self.filled += count;
                self.summed += count;
                self.close_full();
            }
        } else {
            self.end_stretch();
        }
        self.add_moments(&later);
        if later.head.has_ended() || later.head.begun().is_none() {
            self.in_stretch += later.in_first.unwrap_or(0);
            self.end_stretch();
            self.per_stretch.extend(&later.per_stretch);
            self.per_stretch.truncate(MAX_KEPT_MEANS);
        }
        self.in_stretch += later.in_stretch;
        if !later.leading {
            (self.filled, self.summed) = (later.filled, later.summed);
            (self.reference, self.sum) = (later.reference, later.sum);
        }
        self.head.follow(&later.head);
        Ok(())
    }

    /// Adds the windows of another part to the moments (Chan, Golub and LeVeque 1983).
    fn add_moments(&mut self, later: &WindowMeans) {
        let Some(origin) = later.origin else { return };
        let shift = origin - *self.origin.get_or_insert(origin);
        let (here, there) = (self.n as f64, later.n as f64);
        let apart = later.mean + shift - self.mean;
        self.n += later.n;
        self.mean += apart * there / (here + there);
        self.squares += later.squares + apart * apart * here * there / (here + there);
        let room = MAX_KEPT_MEANS.saturating_sub(self.means.len());
        self.means.extend(later.means.iter().take(room));
    }

    /// Closes the open window if it is full.
    fn close_full(&mut self) {
        if self.filled < self.samples {
            return;
        }
        if std::mem::take(&mut self.leading) {
            self.lead = Some(Lead { reference: self.reference, sum: self.sum, count: self.summed });
        } else {
            self.add(self.sum / self.samples as f64);
        }
        (self.filled, self.summed) = (0, 0);
    }

    /// The statistics of all complete windows so far.
    pub fn finish(mut self) -> WindowStatistics {
        self.end_stretch();
        if let Some(first) = self.in_first.filter(|n| *n > 0) {
            self.per_stretch.insert(0, first);
        }
        let kept = self.n as usize <= MAX_KEPT_MEANS;
        WindowStatistics {
            window_s: self.window_s,
            samples: self.samples,
            n: self.n,
            mean: if self.n > 0 { self.origin.unwrap_or(0.0) + self.mean } else { f64::NAN },
            standard_deviation: if self.n > 1 {
                (self.squares / (self.n - 1) as f64).sqrt()
            } else {
                f64::NAN
            },
            means: kept.then_some(self.means),
            per_stretch: self.per_stretch,
        }
    }

    fn end_stretch(&mut self) {
        let continued = self.head.is_leading() && !self.head.is_empty();
        if std::mem::take(&mut self.leading) {
            self.lead = Some(Lead { reference: self.reference, sum: self.sum, count: self.summed });
        }
        if continued {
            self.in_first = Some(self.in_stretch);
        } else if self.in_stretch > 0 && self.per_stretch.len() < MAX_KEPT_MEANS {
            self.per_stretch.push(self.in_stretch);
        }
        self.head.end_stretch();
        (self.in_stretch, self.filled, self.summed) = (0, 0, 0);
    }

    /// Adds the mean of a window, given from its first sample.
    fn add(&mut self, above: f64) {
        let origin = *self.origin.get_or_insert(self.reference);
        let value = (self.reference - origin) + above;
        self.n += 1;
        self.in_stretch += 1;
        let step = value - self.mean;
        self.mean += step / self.n as f64;
        self.squares += step * (value - self.mean);
        if self.means.len() < MAX_KEPT_MEANS {
            self.means.push(self.reference + above);
        }
    }
}

/// Windows that degrees of freedom are computed for.
const MAX_WINDOWS: u64 = 1 << 20;

/// Equivalent degrees of freedom of the variance of `n` adjacent window means: 2E\[s²\]²/Var\[s²\] for Gaussian noise
/// with the given variance of a mean over t, as [`super::model::NoiseModel::mean_variance`] (the unit of t is the caller's; a deterministic ramp has no part in it).
///
/// From traces of the centred covariance matrix, which is Toeplitz: time and memory linear in n. More than a million
/// windows count as a million, which gives too few degrees of freedom rather than too many: stamps in a wrong unit make
/// records of millions of years. `None` below two windows, or when V is no variance.
pub fn edf_of_window_std(n: u64, window: f64, variance_of_average: impl Fn(f64) -> f64) -> Option<f64> {
    if n < 2 {
        return None;
    }
    let n = n.min(MAX_WINDOWS);
    let size = n as usize;
    let count = n as f64;
    // Variance of the angle turned in k windows; its second difference is twice the covariance of window means.
    let angle =
        |k: usize| if k == 0 { 0.0 } else { (k as f64).powi(2) * variance_of_average(k as f64 * window) };
    let mut covariance = Vec::with_capacity(size);
    let (mut before, mut here) = (angle(1), 0.0);
    for k in 0..size {
        let after = angle(k + 1);
        covariance.push(0.5 * (after - 2.0 * here + before));
        (before, here) = (here, after);
    }
    let mut running = 0.0;
    let sums: Vec<f64> = covariance
        .iter()
        .map(|c| {
            running += c;
            running
        })
        .collect();
    let c0 = *covariance.first()?;
    let rows = sums.iter().zip(sums.iter().rev()).map(|(a, b)| a + b - c0);
    let (mut total, mut squares) = (0.0, 0.0);
    rows.for_each(|r| {
        total += r;
        squares += r * r;
    });
    let off_diagonal: f64 =
        covariance.iter().enumerate().skip(1).map(|(k, c)| (size - k) as f64 * c * c).sum();
    let trace = count * c0 - total / count;
    let trace_of_square =
        count * c0 * c0 + 2.0 * off_diagonal - 2.0 * squares / count + (total / count).powi(2);
    let edf = trace * trace / trace_of_square;
    (edf.is_finite() && trace > 0.0 && trace_of_square > 0.0).then(|| edf.clamp(1.0, count - 1.0))
}

#[cfg(test)]
mod tests {
    use super::super::data::NoiseType::{self, AngleRandomWalk, Flicker, RateRandomWalk};
    use super::super::model::unit_mean_variance;
    use super::*;

    fn edf(n: u64, noise: NoiseType) -> f64 {
        edf_of_window_std(n, 1.0, |t| unit_mean_variance(noise, t)).unwrap()
    }

    #[test]
    fn degrees_of_freedom_of_pure_noise() {
        for (n, expected) in [(36, 11.4), (100, 18.3), (360, 29.5), (864, 38.8)] {
            assert!((edf(n, Flicker) - expected).abs() < 0.051, "{n} {}", edf(n, Flicker));
        }
        for n in [2, 36, 360, 100_000] {
            assert!((edf(n, AngleRandomWalk) / (n - 1) as f64 - 1.0).abs() < 1e-6);
        }
        assert!((edf(360, RateRandomWalk) - 2.5).abs() < 0.05, "{}", edf(360, RateRandomWalk));
        let (small, large) = (edf(1000, RateRandomWalk), edf(1_000_000, RateRandomWalk));
        assert!((small / large - 1.0).abs() < 2e-2, "{small} {large}");
        assert!(edf(1_000_000, Flicker) > edf(1000, Flicker));
        assert!(edf_of_window_std(1, 1.0, |t| 1.0 / t).is_none());
        assert!(edf_of_window_std(10, 1.0, |_| f64::NAN).is_none());
        // Stamps in µs taken for seconds: more windows than any memory holds.
        let white = edf_of_window_std(1 << 60, 1.0, |t| 1.0 / t).unwrap();
        assert!((white / f64::from(1 << 20) - 1.0).abs() < 1e-3, "{white}");
    }

    #[test]
    fn the_traces_are_those_of_the_matrix() {
        let (n, v) = (23usize, |t: f64| 1.0 / t - 0.7 * t.ln() - 0.05 * t);
        let angle = |k: usize| if k == 0 { 0.0 } else { (k * k) as f64 * v(k as f64) };
        let c = |i: usize, j: usize| {
            let k = i.abs_diff(j);
            0.5 * (angle(k + 1) - 2.0 * angle(k) + angle(k.abs_diff(1)))
        };
        let full = nalgebra::DMatrix::from_fn(n, n, c);
        let centre = nalgebra::DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - 1.0 / n as f64);
        let hc = centre * full;
        let expected = hc.trace().powi(2) / (&hc * &hc).trace();
        let got = edf_of_window_std(n as u64, 1.0, v).unwrap();
        assert!((got / expected - 1.0).abs() < 1e-10, "{got} {expected}");
    }

    #[test]
    fn ten_means_of_the_thousand_point_suite() {
        let mut k = 1_234_567_890u64;
        let y: Vec<f64> = (0..1000)
            .map(|_| {
                let v = k as f64 / 2_147_483_647.0;
                k = 16807 * k % 2_147_483_647;
                v
            })
            .collect();
        let mut windows = WindowMeans::new(100.0, 1.0);
        y.chunks(77).enumerate().for_each(|(i, block)| windows.push(block, i > 0));
        let s = windows.finish();
        assert_eq!((s.n, s.samples), (10, 100));
        assert!((s.standard_deviation - 0.032_066_564).abs() < 6e-10);
        assert!((s.means.unwrap()[8] - 0.548_936_78).abs() < 6e-9);
    }

    #[test]
    fn windows_start_anew_after_a_gap() {
        let mut windows = WindowMeans::new(3.0, 1.0);
        windows.push(&[1.0, 1.0, 1.0, 50.0, 50.0], false);
        windows.push(&[2.0, 2.0], false);
        windows.push(&[2.0, 70.0], true);
        let s = windows.finish();
        assert_eq!((s.n, s.means, s.per_stretch), (2, Some(vec![1.0, 2.0]), vec![1, 1]));
        assert!((s.standard_deviation - 0.5f64.sqrt()).abs() < 1e-15);
        assert!(WindowMeans::new(3.0, 1.0).finish().standard_deviation.is_nan());
    }

    #[test]
    fn windows_of_whole_samples_fit_within_two_percent() {
        let of = |samples: u64| WindowStatistics {
            window_s: 50.0,
            samples,
            n: 0,
            mean: f64::NAN,
            standard_deviation: f64::NAN,
            means: None,
            per_stretch: vec![],
        };
        assert_eq!(of(101).exact_s(0.5), 50.5);
        let fitting = [97, 99, 100, 101, 103].into_iter().filter(|n| of(*n).fits(0.5));
        assert_eq!(fitting.collect::<Vec<u64>>(), [99, 100, 101]);
    }

    #[test]
    fn degrees_of_freedom_depend_on_the_length_of_the_window() {
        // White noise and a walk: the same windows in tens of the unit of time.
        let variance = |t: f64| 1.0 / t - 0.01 * t;
        let ten = edf_of_window_std(36, 10.0, variance).unwrap();
        let unit = edf_of_window_std(36, 1.0, |t| variance(10.0 * t)).unwrap();
        assert!((ten / unit - 1.0).abs() < 1e-12, "{ten} {unit}");
        assert!(ten < 0.9 * edf_of_window_std(36, 1.0, variance).unwrap());
    }
}
