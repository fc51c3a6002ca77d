//! Averaged periodogram of a record that arrives in blocks (Welch 1967): Hann window, three quarters overlap, mean
//! removed. With half overlap samples between the windows weigh half as much as those under them, and 5 % of what a
//! record tells about its white noise is lost; with three quarters all weigh the same.

use super::data::WelchSpectrum;
use super::part::{Head, MergeError};
use sagnac_fft::{Complex, RealToComplex, real_forward};
use std::sync::Arc;

/// Longest segment, samples.
pub const MAX_SEGMENT: usize = 1 << 16;
/// Shortest segment, samples.
pub const MIN_SEGMENT: usize = 1 << 6;
/// Segments that fit into a record at least, end to end, where the record allows.
const MIN_SEGMENTS: usize = 16;
/// Segments that a sample lies in.
const SEGMENTS_PER_SAMPLE: usize = 4;

/// What the averaged periodogram used and what it could not use.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WelchResult {
    /// The spectrum; `segments` is 0 and `density` empty when no stretch was long enough.
    pub spectrum: WelchSpectrum,
    /// Samples in stretches shorter than a segment, or behind the last whole quarter of a segment of a stretch.
    pub unused_samples: u64,
}

/// Streaming averaged periodogram.
///
/// The segment length is the largest power of two that fits 16 times into the record, at most 65536 and at least 64,
/// and not so long that gaps leave less than half of the samples in stretches of a segment or more. It is chosen after
/// 2^20 samples or at the end, whichever is first; until then samples are kept.
///
/// ```
/// use sagnac_noise::noise::welch::WelchAccumulator;
///
/// // A sinusoid of amplitude 2 deg/h on bin 20 of segments of 256 samples: its variance is 2.
/// let turn = std::f64::consts::TAU * 20.0 / 256.0;
/// let rate: Vec<f64> = (0..1024).map(|i| 2.0 * (turn * f64::from(i)).cos()).collect();
/// let mut welch = WelchAccumulator::with_segment(256);
/// for (k, block) in rate.chunks(100).enumerate() {
///     welch.push(block, k > 0);
/// }
/// let spectrum = welch.finish().spectrum;
///
/// assert_eq!(spectrum.segments, 13);
/// // The density is two-sided, in units of the sample interval.
/// let variance = 2.0 * spectrum.density[1..128].iter().sum::<f64>() / 256.0;
/// assert!((variance - 2.0).abs() < 1e-9);
/// ```
#[derive(Clone)]
pub struct WelchAccumulator {
    head: Head,
    /// Whether the segment length was chosen from the samples of this part.
    chosen: bool,
    kept: Vec<f64>,
    starts: Vec<usize>,
    engine: Option<Engine>,
}

#[derive(Clone)]
struct Engine {
    window: Vec<f64>,
    power_of_window: f64,
    plan: Arc<dyn RealToComplex<f64>>,
    scratch: Vec<Complex<f64>>,
    input: Vec<f64>,
    output: Vec<Complex<f64>>,
    /// Samples of a part that are in no segment of its own.
    skipped: usize,
    /// Samples of the current stretch that a later segment needs.
    tail: Vec<f64>,
    /// Samples and segments of the current stretch.
    samples_in_stretch: u64,
    in_stretch: u64,
    /// The same of the first stretch, where a part continues it and it has ended.
    first_stretch: Option<(u64, u64)>,
    leading: bool,
    power: Vec<f64>,
    segments: u64,
    /// Pairs of segments that lie 1, 2 and 3 quarters of a segment apart.
    pairs: [u64; SEGMENTS_PER_SAMPLE - 1],
    unused: u64,
}

impl Default for WelchAccumulator {
    fn default() -> Self {
        Self::new()
    }
}

impl std::fmt::Debug for WelchAccumulator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WelchAccumulator")
            .field("kept", &self.kept.len())
            .field("segments", &self.engine.as_ref().map(|e| e.segments))
            .finish()
    }
}

impl WelchAccumulator {
    /// An empty accumulator that chooses the segment length itself.
    pub fn new() -> Self {
        WelchAccumulator { head: Head::default(), chosen: false, kept: vec![], starts: vec![], engine: None }
    }

    /// An accumulator with a given segment length: rounded up to a power of two from 64 to 65536.
    pub fn with_segment(samples: usize) -> Self {
        let length = samples.clamp(MIN_SEGMENT, MAX_SEGMENT).next_power_of_two();
        WelchAccumulator { engine: Some(Engine::new(length)), ..Self::new() }
    }

    /// The accumulator of a part with `samples_before` samples of its stretch before it. `segment` is that of
    /// [`WelchAccumulator::with_segment`]; without it the part keeps its samples, and can be merged while it has fewer than
    /// 2^20 of them.
    pub fn of_part(samples_before: u64, segment: Option<usize>) -> Self {
        let Some(segment) = segment else {
            return WelchAccumulator { head: Head::new(samples_before, 0), ..Self::new() };
        };
        let mut part = Self::with_segment(segment);
        if let Some(engine) = part.engine.as_mut().filter(|_| samples_before > 0) {
            let (length, hop) = (engine.window.len(), engine.hop());
            engine.skipped = (hop - (samples_before % hop as u64) as usize) % hop;
            engine.leading = true;
            part.head = Head::new(samples_before, engine.skipped + length - hop);
        }
        part
    }

    /// Samples in a segment; `None` until it is chosen.
    pub fn segment_len(&self) -> Option<usize> {
        self.engine.as_ref().map(|e| e.window.len())
    }

    /// Adds the next part of the recording. Segments are those of one pass, the sums of their powers agree to rounding.
    ///
    /// # Errors
    /// Where the part begins elsewhere than this one ends, or the parts have not the same segment length. A part that has
    /// not chosen its length follows any other.
    pub fn merge(&mut self, later: WelchAccumulator) -> Result<(), MergeError> {
        if later.head.is_empty() {
            return Ok(());
        }
        self.head.accepts(&later.head)?;
        let Some(mut further) = later.engine else {
            let ends = later.starts.iter().skip(1).copied().chain([later.kept.len()]);
            for (k, (from, to)) in later.starts.iter().copied().zip(ends).enumerate() {
                self.push(
                    later.kept.get(from..to).unwrap_or_default(),
                    k == 0 && later.head.begun().is_some(),
                );
            }
            return Ok(());
        };
        if self.segment_len() != Some(further.window.len()) || later.chosen {
            return Err(MergeError::Settings);
        }
        match later.head.begun() {
            Some(_) => self.push(later.head.held(), true),
            None => self.end_stretch(),
        }
        if later.head.ended_inside() {
            self.end_stretch();
            further.first_stretch = None;
        }
        let Some(engine) = &mut self.engine else { return Ok(()) };
        if later.head.is_passed() {
            engine.follow(&further, later.head.begun().is_some() && !later.head.ended_inside());
        }
        engine.add(&further);
        self.head.follow(&later.head);
        Ok(())
    }

    fn end_stretch(&mut self) {
        self.head.end_stretch();
        if let Some(engine) = &mut self.engine {
            engine.end_stretch();
        }
    }

    /// Takes finite contiguous samples; `continues = false` starts a new stretch.
    pub fn push(&mut self, samples: &[f64], continues: bool) {
        if samples.is_empty() {
            return;
        }
        // A copy is held back: the first segments of a part lie in its head too.
        self.head.take(samples, continues);
        if let Some(engine) = &mut self.engine {
            engine.push(samples, continues);
            return;
        }
        if !continues || self.starts.is_empty() {
            self.starts.push(self.kept.len());
        }
        self.kept.extend_from_slice(samples);
        if self.kept.len() >= MIN_SEGMENTS * MAX_SEGMENT {
            self.choose();
        }
    }

    /// The spectrum of everything pushed so far.
    pub fn finish(mut self) -> WelchResult {
        if self.engine.is_none() {
            self.choose();
        }
        self.engine.map(Engine::finish).unwrap_or_default()
    }

    fn choose(&mut self) {
        let ends = self.starts.iter().skip(1).copied().chain([self.kept.len()]);
        let stretches: Vec<(usize, usize)> = self.starts.iter().copied().zip(ends).collect();
        let total = self.kept.len();
        let usable = |length: usize| {
            stretches.iter().map(|(from, to)| to - from).filter(|n| *n >= length).sum::<usize>() * 2 >= total
        };
        let mut length = MAX_SEGMENT;
        while length > MIN_SEGMENT && (length * MIN_SEGMENTS > total || !usable(length)) {
            length /= 2;
        }
        self.chosen = true;
        let mut engine = Engine::new(length);
        for (from, to) in stretches {
            engine.push(self.kept.get(from..to).unwrap_or_default(), false);
        }
        self.kept = vec![];
        self.starts = vec![];
        self.engine = Some(engine);
    }
}

/// The periodic Hann window.
pub(crate) fn hann(length: usize) -> Vec<f64> {
    (0..length).map(|i| (std::f64::consts::PI * i as f64 / length as f64).sin().powi(2)).collect()
}

impl Engine {
    fn new(length: usize) -> Self {
        let window = hann(length);
        let plan = real_forward(length);
        Engine {
            power_of_window: window.iter().map(|w| w * w).sum(),
            window,
            scratch: plan.make_scratch_vec(),
            input: plan.make_input_vec(),
            output: plan.make_output_vec(),
            plan,
            skipped: 0,
            tail: Vec::with_capacity(length),
            samples_in_stretch: 0,
            in_stretch: 0,
            first_stretch: None,
            leading: false,
            power: vec![0.0; length / 2 + 1],
            segments: 0,
            pairs: [0; SEGMENTS_PER_SAMPLE - 1],
            unused: 0,
        }
    }

    fn push(&mut self, samples: &[f64], continues: bool) {
        if !continues {
            self.end_stretch();
        }
        let (length, hop) = (self.window.len(), self.hop());
        let (_, mut rest) = samples.split_at(self.skipped.min(samples.len()));
        self.skipped -= samples.len() - rest.len();
        self.samples_in_stretch += rest.len() as u64;
        while !rest.is_empty() {
            let (now, later) = rest.split_at((length - self.tail.len()).min(rest.len()));
            self.tail.extend_from_slice(now);
            rest = later;
            if self.tail.len() == length {
                self.transform();
                self.tail.drain(..hop);
            }
        }
    }

    /// Samples from one segment to the next.
    fn hop(&self) -> usize {
        self.window.len() / SEGMENTS_PER_SAMPLE
    }

    /// Samples of a stretch that are in none of its segments.
    fn unused_of(&self, (samples, segments): (u64, u64)) -> u64 {
        let used = segments.checked_sub(1).map_or(0, |n| n * self.hop() as u64 + self.window.len() as u64);
        samples.saturating_sub(used)
    }

    fn end_stretch(&mut self) {
        let stretch = (self.samples_in_stretch, self.in_stretch);
        if std::mem::take(&mut self.leading) {
            self.first_stretch = Some(stretch);
        } else {
            self.unused += self.unused_of(stretch);
        }
        self.tail.clear();
        (self.samples_in_stretch, self.in_stretch, self.skipped) = (0, 0, 0);
    }

    /// Goes on where a later part ends, after what it held back has been replayed; `joined`: its first stretch continues
    /// the current one.
    fn follow(&mut self, later: &Engine, joined: bool) {
        if joined {
            let (samples, segments) =
                later.first_stretch.unwrap_or((later.samples_in_stretch, later.in_stretch));
            for (apart, pairs) in (1..).zip(&mut self.pairs) {
                let lapping = |segments: u64| segments.saturating_sub(apart);
                *pairs += lapping(self.in_stretch + segments) - lapping(self.in_stretch) - lapping(segments);
            }
            // The first samples of its own are those of the replay.
            self.samples_in_stretch += samples.saturating_sub((self.window.len() - self.hop()) as u64);
            self.in_stretch += segments;
        }
        if later.leading {
            self.tail.clone_from(&later.tail);
        } else {
            if joined {
                self.end_stretch();
            }
            self.tail.clone_from(&later.tail);
            (self.samples_in_stretch, self.in_stretch) = (later.samples_in_stretch, later.in_stretch);
        }
    }

    /// Adds the sums of a later part.
    fn add(&mut self, later: &Engine) {
        for (power, more) in self.power.iter_mut().zip(&later.power) {
            *power += more;
        }
        self.segments += later.segments;
        for (pairs, more) in self.pairs.iter_mut().zip(later.pairs) {
            *pairs += more;
        }
        self.unused += later.unused;
    }

    fn transform(&mut self) {
        // A mean that was rounded to the digits of a large offset would leave a constant behind.
        let first = self.tail.first().copied().unwrap_or(0.0);
        let rest = self.tail.iter().map(|y| y - first).sum::<f64>() / self.tail.len() as f64;
        for ((x, y), w) in self.input.iter_mut().zip(&self.tail).zip(&self.window) {
            *x = ((y - first) - rest) * w;
        }
        // Lengths come from the plan itself, so that this cannot fail.
        if self.plan.process_with_scratch(&mut self.input, &mut self.output, &mut self.scratch).is_ok() {
            for (p, z) in self.power.iter_mut().zip(&self.output) {
                *p += z.norm_sqr();
            }
            self.segments += 1;
            for (apart, pairs) in (1..).zip(&mut self.pairs) {
                *pairs += u64::from(self.in_stretch >= apart);
            }
            self.in_stretch += 1;
        }
    }

    fn finish(mut self) -> WelchResult {
        self.end_stretch();
        self.unused += self.first_stretch.map_or(0, |stretch| self.unused_of(stretch));
        if self.segments == 0 {
            return WelchResult { unused_samples: self.unused, ..WelchResult::default() };
        }
        let count = self.segments as f64;
        let hop = self.hop();
        // Sums over two windows so many quarters apart, each with the pairs of segments that lie so: amplitudes that
        // both hold make a bin of one like that of the other, powers make samples weigh more than once.
        let (mut alike, mut square) = (count, count * window_product_sum(&self.window, 0, 2));
        for (apart, pairs) in (1..).zip(self.pairs) {
            let pairs = 2.0 * pairs as f64;
            alike +=
                pairs * (window_product_sum(&self.window, apart * hop, 1) / self.power_of_window).powi(2);
            square += pairs * window_product_sum(&self.window, apart * hop, 2);
        }
        let samples = (count * self.power_of_window).powi(2) / square;
        let scale = 1.0 / (count * self.power_of_window);
        self.power.iter_mut().for_each(|p| *p *= scale);
        WelchResult {
            spectrum: WelchSpectrum {
                segment_len: self.window.len(),
                segments: self.segments,
                effective_averages: count * count / alike,
                averages_in_sums: 2.0 * samples / self.window.len() as f64,
                density: self.power,
            },
            unused_samples: self.unused,
        }
    }
}

/// Sum of a power of the products of a window and itself, moved by so many samples.
fn window_product_sum(window: &[f64], moved: usize, power: i32) -> f64 {
    window.iter().zip(window.iter().skip(moved)).map(|(a, b)| (a * b).powi(power)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn white(count: usize, seed: u64) -> Vec<f64> {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        (0..count).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    #[test]
    fn white_noise_has_its_two_sided_level_and_scatter() {
        let sigma = 3.0;
        let y: Vec<f64> = white(1 << 20, 1).iter().map(|v| sigma * v + 1e6).collect();
        let mut welch = WelchAccumulator::with_segment(1024);
        y.chunks(1000).enumerate().for_each(|(k, b)| welch.push(b, k > 0));
        let result = welch.finish();
        let s = &result.spectrum;
        assert_eq!((s.segments, result.unused_samples), (4093, 0));
        let bins = &s.density[4..s.density.len() - 1];
        let mean = bins.iter().sum::<f64>() / bins.len() as f64;
        assert!((mean / 9.0 - 1.0).abs() < 4e-3, "{mean}");
        // Relative variance of a bin is one over the number of averages.
        let variance = bins.iter().map(|p| (p / mean - 1.0).powi(2)).sum::<f64>() / (bins.len() - 1) as f64;
        let averages = 1.0 / variance;
        assert!((averages / s.effective_averages - 1.0).abs() < 0.2, "{averages} {}", s.effective_averages);
        // Correlations of a Hann window with itself moved by one, two and three quarters.
        let [a, b, c] = [0.659_155, 1.0 / 6.0, 0.007_511].map(|r: f64| r * r);
        let expected = 4093.0f64.powi(2) / (4093.0 + 2.0 * (4092.0 * a + 4091.0 * b + 4090.0 * c));
        assert!((s.effective_averages / expected - 1.0).abs() < 1e-5, "{}", s.effective_averages);
        // All bins together weigh as the samples, but for those at the two ends.
        let weight = s.averages_in_sums * 512.0 / (1u64 << 20) as f64;
        assert!((0.998..1.0).contains(&weight), "{weight}");
    }

    #[test]
    fn sums_over_bins_scatter_as_stated() {
        let (runs, samples) = (200, 1 << 14);
        let sums: Vec<f64> = (0..runs)
            .map(|seed| {
                let mut welch = WelchAccumulator::with_segment(1024);
                welch.push(&white(samples, 900 + seed), false);
                welch.finish().spectrum.density[2..512].iter().sum::<f64>() / 510.0
            })
            .collect();
        let mut welch = WelchAccumulator::with_segment(1024);
        welch.push(&vec![0.0; samples], false);
        let stated = 2.0 / (510.0 * welch.finish().spectrum.averages_in_sums);
        let variance = sums.iter().map(|s| (s - 1.0).powi(2)).sum::<f64>() / runs as f64;
        // Of 200: 1 ± 0.1.
        assert!((variance / stated - 1.0).abs() < 0.3, "{variance} {stated}");
    }

    #[test]
    fn power_is_kept() {
        // Parseval: a sinusoid of amplitude A on a bin has the variance A²/2.
        let length = 256;
        let y: Vec<f64> =
            (0..length).map(|i| 2.0 * (std::f64::consts::TAU * 20.0 * f64::from(i) / 256.0).cos()).collect();
        let mut welch = WelchAccumulator::with_segment(256);
        welch.push(&y, false);
        let s = welch.finish().spectrum;
        let inner: f64 = s.density[1..128].iter().sum();
        let variance = (s.density[0] + 2.0 * inner + s.density[128]) / 256.0;
        assert!((variance - 2.0).abs() < 1e-12, "{variance}");
    }

    #[test]
    fn segments_follow_length_and_gaps() {
        let length = |n: usize, every: usize| {
            let mut welch = WelchAccumulator::new();
            white(n, 2).chunks(every).for_each(|b| welch.push(b, false));
            let r = welch.finish();
            (r.spectrum.segment_len, r.spectrum.segments, r.unused_samples)
        };
        assert_eq!(length(100_000, 100_000).0, 4096);
        assert_eq!(length(1 << 20, 1 << 20), (65536, 61, 0));
        assert_eq!(length(100_000, 1000).0, 512);
        assert_eq!(length(100, 1000), (64, 3, 4));
        assert_eq!(length(100, 50), (0, 0, 100));
        assert_eq!(WelchAccumulator::new().finish(), WelchResult::default());
    }
}
