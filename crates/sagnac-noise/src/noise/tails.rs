//! The spread of samples about their local mean, and whether values far out are missing: noise of many causes is normal or has
//! longer tails, and values that were clipped, thinned out or replaced have shorter ones.
//!
//! Two signs tell it: an excess kurtosis that is too low, and too few values beyond some distance between two and four standard
//! deviations. The second one sees a clipped tail in a few thousand samples, where the moments do not.

use super::histogram::Histogram;
use crate::estimate::{chi_square_tail, normal_probability};

/// Fewest samples of a block from whose line deviations are taken.
const MIN_LINE_BLOCK: usize = 64;
/// Samples from which the spread of values is judged.
const MIN_SAMPLES: u64 = 2048;
/// Distances from the mean beyond which values are counted, standard deviations.
const COUNTED_SIGMA: std::ops::RangeInclusive<f64> = 2.0..=4.0;
/// Steps between these distances where single deviations are at hand, standard deviations.
const SIGMA_STEP: f64 = 0.01;
/// Excess kurtosis of Gaussian noise clipped beyond three standard deviations is −0.16, and its N 1.5 % too small.
const MIN_EXCESS_KURTOSIS: f64 = -0.1;
/// Standard errors that it must lie below zero by.
const MIN_STANDARD_ERRORS: f64 = 8.0;
/// Share of the values expected far out below which they were taken out.
const MIN_SHARE_BEYOND: f64 = 0.25;
/// Probability of as few by chance, at one distance, below which chance is no explanation. Counts at the distances go
/// together: over all of them it is some ten times as large.
const MAX_CHANCE: f64 = 1e-7;
/// Share of the variance that lines, narrow bands and rounding may each have where the spread of the values is judged.
const MAX_PERIODIC_SHARE: f64 = 0.2;
/// Lags at which the correlation of deviations is taken, samples.
const CORRELATION_LAGS: usize = 16;
/// Variance of neighbouring differences, halved, over the variance: samples outside wander within a block.
const WHITE_RATIO: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Values beyond a distance from the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Beyond {
    /// Distance, standard deviations.
    sigma: f64,
    /// Values beyond it on either side.
    count: u64,
}

/// Deviations of samples from their local mean or line.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviations {
    /// Deviations.
    pub samples: u64,
    /// Standard deviation, deg/h.
    pub standard_deviation: f64,
    /// Root of the mean square of differences of neighbours over √2, deg/h: the Allan deviation at one sample.
    pub neighbour_deviation: f64,
    /// Fourth moment over the squared variance, less 3.
    pub excess_kurtosis: f64,
    /// Share of the variance that goes on like a line, by the correlation at several lags; 0 where lines are known otherwise.
    periodic_share: f64,
    /// Values far out, at rising distances.
    beyond: Vec<Beyond>,
}

/// What shortens the tails of values that nobody touched.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shortening {
    /// Variance of each line and narrow band that was found in them, (deg/h)².
    pub periodic: Vec<f64>,
    /// Step of the output, deg/h; 0 where it is fine.
    pub step_deg_h: f64,
}

/// How values are spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TailShape {
    /// Values.
    pub samples: u64,
    /// Fourth moment over the squared variance, less 3.
    pub excess_kurtosis: f64,
    /// How much shorter lines and rounding make the tails: the same, positive.
    pub explained: f64,
    /// Distance beyond which values are counted where that tells most, standard deviations.
    pub sigma: f64,
    /// Values beyond.
    pub beyond: u64,
    /// How many of them normal noise has.
    pub expected_beyond: f64,
}

impl Deviations {
    /// Deviations from block means, as a histogram holds them. `neighbour_deviation`: Allan deviation at one sample, deg/h.
    pub fn of_histogram(histogram: &Histogram, neighbour_deviation: f64) -> Deviations {
        let deviation = histogram.standard_deviation;
        let middle = histogram.counts.len() / 2;
        let at = |bins: usize| {
            let inside: u64 = histogram.counts.get(middle - bins..middle + bins)?.iter().sum();
            let sigma = bins as f64 * histogram.bin_width / deviation;
            Some(Beyond { sigma, count: histogram.samples.saturating_sub(inside) })
        };
        Deviations {
            samples: histogram.samples,
            standard_deviation: deviation,
            neighbour_deviation,
            excess_kurtosis: histogram.excess_kurtosis,
            periodic_share: 0.0,
            beyond: (1..=middle).filter_map(at).filter(|b| COUNTED_SIGMA.contains(&b.sigma)).collect(),
        }
    }

    /// Deviations from straight lines through blocks of each stretch, at most so long and equally long within a stretch: a
    /// course that is nearly straight over that time does not widen them. The longer the blocks, the less the error of a line
    /// blurs an edge at which values were clipped. `None` without a block of 64 samples, or where nothing scatters.
    pub fn from_lines<'a>(
        stretches: impl IntoIterator<Item = &'a [f64]>,
        longest_block: usize,
    ) -> Option<Deviations> {
        let mut all: Vec<f64> = Vec::new();
        let (mut differences, mut pairs) = (0.0, 0.0);
        let mut products = [(0.0, 0.0); CORRELATION_LAGS];
        for stretch in stretches {
            let length = stretch.len().div_ceil(stretch.len().div_ceil(longest_block.max(1)).max(1));
            let blocks = stretch.chunks(length.max(1)).filter(|b| b.len() >= MIN_LINE_BLOCK);
            for deviations in blocks.filter(|b| b.iter().all(|v| v.is_finite())).map(from_line) {
                differences += deviations.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>();
                pairs += (deviations.len() - 1) as f64;
                for (lag, (product, count)) in (1..).zip(&mut products) {
                    *product += deviations.iter().zip(&deviations[lag..]).map(|(a, b)| a * b).sum::<f64>();
                    *count += (deviations.len() - lag) as f64;
                }
                all.extend(deviations);
            }
        }
        let n = all.len() as f64;
        let moment = |power: i32| all.iter().map(|d| d.powi(power)).sum::<f64>() / n;
        let variance = moment(2);
        if all.is_empty() || variance.is_nan() || variance <= 0.0 {
            return None;
        }
        let deviation = variance.sqrt();
        let mut distances: Vec<f64> = all.iter().map(|d| d.abs() / deviation).collect();
        distances.sort_by(f64::total_cmp);
        // A line of share p has the correlations p·cos, whose mean square is p²/2.
        let squares: f64 = products.iter().map(|(sum, count)| (sum / (count * variance)).powi(2)).sum();
        let steps = ((COUNTED_SIGMA.end() - COUNTED_SIGMA.start()) / SIGMA_STEP).round() as usize;
        let at = |step: usize| {
            let sigma = COUNTED_SIGMA.start() + step as f64 * SIGMA_STEP;
            Beyond { sigma, count: (distances.len() - distances.partition_point(|d| *d <= sigma)) as u64 }
        };
        Some(Deviations {
            samples: all.len() as u64,
            standard_deviation: deviation,
            neighbour_deviation: (0.5 * differences / pairs).sqrt(),
            excess_kurtosis: moment(4) / (variance * variance) - 3.0,
            periodic_share: (2.0 * squares / CORRELATION_LAGS as f64).sqrt(),
            beyond: (0..=steps).map(at).collect(),
        })
    }

    /// The shape of the tails; `None` for too few samples, and where something else than noise rules them: a wander, lines,
    /// coarse steps.
    pub fn tails(&self, shortening: &Shortening) -> Option<TailShape> {
        let variance = self.standard_deviation.powi(2);
        let ratio = self.neighbour_deviation.powi(2) / variance;
        if self.samples < MIN_SAMPLES || variance.is_nan() || !WHITE_RATIO.contains(&ratio) {
            return None;
        }
        let shares = || shortening.periodic.iter().map(|v| v / variance).chain([self.periodic_share]);
        let rounding = shortening.step_deg_h.powi(2) / (12.0 * variance);
        if shares().sum::<f64>() > MAX_PERIODIC_SHARE || rounding > MAX_PERIODIC_SHARE {
            return None;
        }
        let explained = shares().map(|s| 1.5 * s * s).sum::<f64>() + 1.2 * rounding * rounding;
        // Values on a grid are those within half a step of them.
        let half_step = 0.5 * shortening.step_deg_h / self.standard_deviation;
        let shape = |b: &Beyond| TailShape {
            samples: self.samples,
            excess_kurtosis: self.excess_kurtosis,
            explained,
            sigma: b.sigma,
            beyond: b.count,
            expected_beyond: 2.0 * normal_probability(-b.sigma - half_step) * self.samples as f64,
        };
        let cut = self.beyond.iter().map(shape).filter(TailShape::is_cut);
        let most_telling = cut.min_by(|a, b| a.chance().total_cmp(&b.chance()));
        // Where none tells, what lies three standard deviations out is shown.
        let off = |b: &&Beyond| (b.sigma - 3.0).abs();
        let usual = || self.beyond.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(shape);
        most_telling.or_else(usual)
    }
}

/// Deviations of values from the least-squares line through them.
fn from_line(values: &[f64]) -> Vec<f64> {
    let n = values.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let first = values.first().copied().unwrap_or(0.0);
    let mean = values.iter().map(|v| v - first).sum::<f64>() / n;
    let place = |i: usize| i as f64 - middle;
    let spread = n * (n * n - 1.0) / 12.0;
    let slope = values.iter().enumerate().map(|(i, v)| place(i) * (v - first)).sum::<f64>() / spread;
    values.iter().enumerate().map(|(i, v)| v - first - mean - slope * place(i)).collect()
}

impl TailShape {
    /// Values expected beyond, less what lines and rounding may take away.
    fn expected(&self) -> f64 {
        self.expected_beyond * (1.0 - self.explained.min(1.0))
    }

    /// Probability of as few values beyond by chance.
    fn chance(&self) -> f64 {
        // The probability of as few of a Poisson law is that of a χ².
        chi_square_tail(2.0 * self.expected(), 2.0 * (self.beyond as f64 + 1.0))
    }

    /// Standard error of the excess kurtosis of normal noise.
    pub fn kurtosis_error(&self) -> f64 {
        (24.0 / self.samples as f64).sqrt()
    }

    /// True where values far out are missing: of values that were taken out by hand the moments tell only in long records.
    fn is_cut(&self) -> bool {
        (self.beyond as f64) < MIN_SHARE_BEYOND * self.expected() && self.chance() < MAX_CHANCE
    }

    /// True where the values are spread less widely than any noise.
    pub fn is_short(&self) -> bool {
        let least = MIN_EXCESS_KURTOSIS.min(-MIN_STANDARD_ERRORS * self.kurtosis_error()) - self.explained;
        self.excess_kurtosis <= least || self.is_cut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::histogram::HistogramAccumulator;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// Noise of unit variance, changed value by value, on a course that swings by six standard deviations.
    fn on_a_course(seed: u64, n: usize, change: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let course = |i: usize| 3.0 * (std::f64::consts::TAU * i as f64 / 8000.0).sin();
        (0..n).map(|i| course(i) + change(StandardNormal.sample(&mut rng))).collect()
    }

    fn shape(values: &[f64]) -> TailShape {
        Deviations::from_lines([values], 256).unwrap().tails(&Shortening::default()).unwrap()
    }

    #[test]
    fn clipped_tails_are_seen_about_a_course() {
        for (n, clip) in [(3780, 2.4), (7560, 2.7), (30_000, 3.0)] {
            for seed in 0..20 {
                let clipped = on_a_course(seed, n, |v| v.clamp(-clip, clip));
                assert!(shape(&clipped).is_short(), "{n} {clip} {seed}: {:?}", shape(&clipped));
            }
        }
    }

    #[test]
    fn noise_is_not_taken_for_clipped() {
        for seed in 0..400 {
            let n = [2048, 4000, 8000, 20_000][seed as usize % 4];
            let noise = shape(&on_a_course(seed, n, |v| v));
            assert!(!noise.is_short(), "{seed}: {noise:?}");
            assert!((noise.sigma - 3.0).abs() < 0.01);
            // Longer tails are those of some noise.
            let heavy = shape(&on_a_course(seed, n, |v| v * (1.0 + 0.3 * v.abs())));
            assert!(!heavy.is_short(), "{seed}: {heavy:?}");
        }
    }

    #[test]
    fn a_grid_is_no_clipping() {
        for step in [0.1, 0.5, 1.0, 1.5] {
            let values: Vec<f64> =
                on_a_course(7, 40_000, |v| v).iter().map(|v| (v / step).round() * step).collect();
            let shortening = Shortening { step_deg_h: step, ..Shortening::default() };
            let found = Deviations::from_lines([&values[..]], 256).unwrap().tails(&shortening).unwrap();
            assert!(!found.is_short(), "{step}: {found:?}");
        }
    }

    #[test]
    fn a_line_is_no_clipping() {
        for (share, frequency) in [(0.15f64, 0.11), (0.15, 0.31), (0.7, 0.11), (0.7, 0.23)] {
            let size = (2.0 * share / (1.0 - share)).sqrt();
            let noise = on_a_course(11, 40_000, |v| v);
            let line = |i: usize| size * (std::f64::consts::TAU * frequency * i as f64).sin();
            let values: Vec<f64> = noise.iter().enumerate().map(|(i, v)| v + line(i)).collect();
            let found = Deviations::from_lines([&values[..]], 256).unwrap().tails(&Shortening::default());
            assert_eq!(found.is_some(), share < MAX_PERIODIC_SHARE, "{share} {frequency}");
            assert!(found.is_none_or(|f| !f.is_short()), "{share} {frequency}: {found:?}");
        }
    }

    #[test]
    fn a_histogram_tells_the_same_at_rest_and_a_wander_nothing() {
        let rests = |change: fn(f64) -> f64| -> Vec<f64> {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
            (0..40_000).map(|_| change(StandardNormal.sample(&mut rng))).collect()
        };
        let of_histogram = |values: &[f64]| {
            let mut histogram = HistogramAccumulator::new();
            histogram.push(values, false);
            let histogram = histogram.finish();
            let deviation = histogram.standard_deviation;
            Deviations::of_histogram(&histogram, deviation).tails(&Shortening::default()).unwrap()
        };
        let (clipped, plain) = (rests(|v| v.clamp(-3.0, 3.0)), rests(|v| v));
        assert!(of_histogram(&clipped).is_short() && shape(&clipped).is_short());
        assert!(!of_histogram(&plain).is_short() && !shape(&plain).is_short());
        let walk: Vec<f64> = plain
            .iter()
            .scan(0.0, |sum, v| {
                Some({
                    *sum += v;
                    *sum
                })
            })
            .collect();
        assert_eq!(Deviations::from_lines([&walk[..]], 256).unwrap().tails(&Shortening::default()), None);
        assert_eq!(Deviations::from_lines([&[1.0; 640][..]], 256), None);
        assert_eq!(shape(&plain[..2048]).samples, 2048);
        assert_eq!(
            Deviations::from_lines([&plain[..1984]], 256).unwrap().tails(&Shortening::default()),
            None
        );
    }
}
