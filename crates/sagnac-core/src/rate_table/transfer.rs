//! Transfer function of a gyro: response of the output to the motion of a table over frequency, and what follows from it.
//!
//! Sources: IEEE Std 952-2020, 12.15 (frequency response); Bendat and Piersol, Random Data, chapters 6 and 9.

use super::cross_spectrum::Bin;
use super::transfer_model::{FittedModel, LARGEST_RELATIVE_MISFIT, Model, Order, SHARED_BY_BINS, fit};
use crate::estimate::{LowerLimit, SCORE_ONE_SIDED_95, SCORE_TWO_SIDED_95, Spread, UpperLimit};
use crate::numeric::optimize::bisect;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// Bands of an octave over which bins are joined.
const BANDS_PER_OCTAVE: f64 = 12.0;

/// Fewest bands that tell a response.
const FEWEST_BANDS: usize = 4;

/// A model counts beside the best one where its criterion is larger by no more than this.
const RIVAL_CRITERION: f64 = 6.0;

/// Probability with which a bound holds.
pub const CLAIM_CONFIDENCE: f64 = 0.95;

/// How far above the highest frequency measured a model is followed, as a factor.
const FOLLOWED_UP_TO: f64 = 1e3;

/// What a test of the transfer function asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferTest {
    /// End of the band of which the flatness is stated, Hz.
    pub flat_to_hz: Option<f64>,
    /// Least share of the power of the output that the input explains at a frequency that counts.
    pub least_coherence: f64,
}

/// The response in a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Natural logarithm of the gain over that at frequency zero.
    pub log_gain: f64,
    /// Phase, rad, without turns left out.
    pub phase: f64,
    /// Standard uncertainty of both.
    pub standard: f64,
}

/// The transfer function of a channel.
#[derive(Debug, Clone)]
pub struct Transfer {
    /// Channel.
    pub channel: String,
    /// Bands, by frequency.
    pub bands: Vec<Band>,
    /// Fitted models, the best first.
    pub fits: Vec<FittedModel>,
    /// What was asked for.
    pub test: TransferTest,
}

/// A quantity of a transfer function, as far as the record shows it.
#[derive(Debug, Clone, PartialEq)]
pub enum Shown {
    /// A value.
    Value(f64, Spread),
    /// A bound below.
    AtLeast(LowerLimit),
    /// A bound above.
    AtMost(UpperLimit),
    /// Nothing.
    Nothing,
}

/// The transfer function in the bins of a channel.
pub fn evaluate(channel: &str, bins: &[Bin], test: TransferTest) -> Transfer {
    let used: Vec<Bin> = bins.iter().copied().filter(|b| b.coherence >= test.least_coherence).collect();
    let fits = fit(&used);
    let bands = fits.first().map_or_else(Vec::new, |best| bands(&used, best));
    let (bands, fits) = if bands.len() < FEWEST_BANDS { (vec![], vec![]) } else { (bands, fits) };
    Transfer { channel: channel.to_owned(), bands, fits, test }
}

/// Bins joined in narrow bands by their ratio to a model, which hardly changes in a band.
fn bands(bins: &[Bin], best: &FittedModel) -> Vec<Band> {
    let model = &best.model;
    // Scatter about the model beyond the noise is that of the bands too.
    let shared = SHARED_BY_BINS * best.misfit.max(1.0);
    let band_of = |f: f64| (BANDS_PER_OCTAVE * f.log2()).floor() as i64;
    let groups = bins.chunk_by(|a, b| band_of(a.frequency_hz) == band_of(b.frequency_hz));
    let mut found: Vec<Band> = groups
        .filter_map(|group| {
            let (mut weights, mut ratio, mut log_f) = (0.0, sagnac_fft::Complex::default(), 0.0);
            for b in group {
                let expected = model.read(b);
                let weight = expected.norm_sqr() / b.variance;
                if !weight.is_finite() || weight <= 0.0 {
                    continue;
                }
                weights += weight;
                ratio += b.response / expected * weight;
                log_f += b.frequency_hz.ln() * weight;
            }
            if weights <= 0.0 {
                return None;
            }
            let (ratio, frequency_hz) = (ratio / weights, (log_f / weights).exp());
            Some(Band {
                frequency_hz,
                log_gain: ratio.norm().ln() + model.shape(frequency_hz).norm().ln(),
                phase: ratio.arg() + model.phase(frequency_hz),
                standard: (shared / weights).sqrt(),
            })
        })
        .collect();
    found.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    found
}

impl Transfer {
    /// The model that describes it best.
    pub fn best(&self) -> Option<&FittedModel> {
        self.fits.first()
    }

    /// Highest frequency measured, Hz.
    pub fn highest_hz(&self) -> Option<f64> {
        self.bands.last().map(|b| b.frequency_hz)
    }

    /// True where the best model leaves more than noise.
    pub fn misfits(&self) -> bool {
        self.best().is_some_and(|f| f.relative_misfit > LARGEST_RELATIVE_MISFIT)
    }

    /// Models that the record does not tell from the best one.
    pub fn rivals(&self) -> impl Iterator<Item = &FittedModel> {
        let best = self.best().map_or(f64::INFINITY, |f| f.criterion);
        let counts = move |(i, f): &(usize, &FittedModel)| {
            *i == 0 || f.criterion <= best + RIVAL_CRITERION && f.is_determined()
        };
        self.fits.iter().enumerate().filter(counts).map(|(_, f)| f)
    }

    /// Frequency where the gain falls to 1/√2, between the bands.
    pub fn bandwidth_3db(&self) -> Shown {
        let gain = self.best().and_then(|f| Some(f.standard(|m| Some(m.gain()))? / f.model.gain()));
        let level = FRAC_1_SQRT_2.ln();
        let of_model = |m: &Model, f: f64| m.shape(f).norm().ln();
        self.crossing(level, gain.unwrap_or(0.0).abs(), |b| b.log_gain, of_model)
    }

    /// Frequency where the phase reaches −90°, between the bands.
    pub fn bandwidth_phase_90(&self) -> Shown {
        self.crossing(-FRAC_PI_2, 0.0, |b| b.phase, Model::phase)
    }

    /// Where a quantity of the bands falls through a level: what the model leaves of it is followed from band to band.
    fn crossing(
        &self,
        level: f64,
        common: f64,
        of_band: impl Fn(&Band) -> f64,
        of_model: impl Fn(&Model, f64) -> f64,
    ) -> Shown {
        let Some(model) = self.best().map(|f| &f.model) else { return Shown::Nothing };
        let uncertain = |b: &Band| b.standard.hypot(common);
        let below = |b: &Band| of_band(b) < level;
        let stays = self
            .bands
            .iter()
            .enumerate()
            .position(|(i, b)| below(b) && self.bands.get(i + 1).is_none_or(below));
        let pair = stays.and_then(|i| Some((self.bands.get(i.checked_sub(1)?)?, self.bands.get(i)?)));
        let Some((a, b)) = pair else {
            // All bands lie on one side.
            let last =
                self.bands.iter().rev().find(|b| of_band(b) - SCORE_ONE_SIDED_95 * uncertain(b) > level);
            return match (stays, last) {
                (None, Some(last)) => {
                    Shown::AtLeast(LowerLimit { value: last.frequency_hz, coverage: CLAIM_CONFIDENCE })
                }
                _ => Shown::Nothing,
            };
        };
        let left = |band: &Band| of_band(band) - of_model(model, band.frequency_hz);
        let (from, to) = (a.frequency_hz.ln(), b.frequency_hz.ln());
        let at = |log_f: f64| {
            let share = (log_f - from) / (to - from);
            of_model(model, log_f.exp()) + left(a) + share * (left(b) - left(a))
        };
        let found = bisect(from, to, 60, |f| at(f) > level).middle();
        let step = 1e-3 * (to - from);
        let slope = (at(found + step) - at(found - step)) / (2.0 * step);
        let noise = (0.5 * (a.standard.powi(2) + b.standard.powi(2)) + common * common).sqrt();
        let unsure = noise.hypot(unsure_between(a, b) * (left(b) - left(a)));
        let standard = unsure / slope.abs();
        if !standard.is_finite() {
            return Shown::Nothing;
        }
        Shown::Value(found.exp(), Spread::by_score(|score| (found + score * standard).exp()))
    }

    /// Frequency where the gain falls to 1/√2, by the models that the record does not tell apart.
    pub fn bandwidth_by_model(&self) -> Shown {
        let Some(highest) = self.highest_hz().filter(|_| !self.misfits()) else { return Shown::Nothing };
        let falls = |m: &Model| m.falls(FOLLOWED_UP_TO * highest, |m, f| m.shape(f).norm() - FRAC_1_SQRT_2);
        let ends: Vec<Option<(f64, f64)>> = self
            .rivals()
            .map(|f| Some((falls(&f.model)?.ln(), f.standard(|m| Some(falls(m)?.ln()))?)))
            .collect();
        let known = ends.iter().flatten();
        let low = known.clone().map(|(at, sd)| at - SCORE_TWO_SIDED_95 * sd).fold(f64::INFINITY, f64::min);
        let high = known.map(|(at, sd)| at + SCORE_TWO_SIDED_95 * sd).fold(f64::NEG_INFINITY, f64::max);
        if ends.iter().any(Option::is_none) {
            // A rival does not fall at all: there is no upper end.
            let value = low.exp().max(highest);
            let limit = LowerLimit {
                value: if low.is_finite() { low.exp() } else { value },
                coverage: CLAIM_CONFIDENCE,
            };
            return Shown::AtLeast(limit);
        }
        match ends.first() {
            Some(Some((at, _))) => Shown::Value(at.exp(), between(low, *at, high, f64::exp)),
            _ => Shown::Nothing,
        }
    }

    /// Delay of slow motion, s, by the models that the record does not tell apart.
    pub fn latency_s(&self) -> Shown {
        let Some(best) = self.best().filter(|_| !self.misfits()) else { return Shown::Nothing };
        let ends: Vec<(f64, f64)> = self
            .rivals()
            .filter_map(|f| Some((f.model.latency_s(), f.standard(|m| Some(m.latency_s()))?)))
            .collect();
        let low = ends.iter().map(|(at, sd)| at - SCORE_TWO_SIDED_95 * sd).fold(f64::INFINITY, f64::min);
        let high = ends.iter().map(|(at, sd)| at + SCORE_TWO_SIDED_95 * sd).fold(f64::NEG_INFINITY, f64::max);
        if ends.is_empty() {
            return Shown::Nothing;
        }
        let at = best.model.latency_s();
        Shown::Value(at, between(low, at, high, |v| v))
    }

    /// Largest rise of the gain over that at frequency zero, dB.
    pub fn resonance_peak_db(&self) -> Shown {
        self.largest(f64::INFINITY, |b| b.log_gain)
    }

    /// Largest deviation of the gain from that at frequency zero up to the end of the stated band, dB.
    pub fn flatness_db(&self) -> Shown {
        match (self.test.flat_to_hz, self.highest_hz()) {
            // A band reaches half a band beyond its frequency.
            (Some(to), Some(highest)) if highest * 2f64.powf(1.0 / BANDS_PER_OCTAVE) >= to => {
                self.largest(to, |b| b.log_gain.abs())
            }
            _ => Shown::Nothing,
        }
    }

    /// The largest value among the bands up to a frequency, in dB. Each band may be the largest: the ends of the interval are the
    /// largest of the ends that hold for all bands at once.
    fn largest(&self, up_to_hz: f64, of_band: impl Fn(&Band) -> f64) -> Shown {
        let gain = self.best().and_then(|f| Some(f.standard(|m| Some(m.gain()))? / f.model.gain()));
        let common = gain.unwrap_or(0.0).abs();
        let count = self.bands.iter().filter(|b| b.frequency_hz <= up_to_hz).count().max(1) as f64;
        let followed = self.followed(up_to_hz);
        let bands = || followed.iter();
        let for_all = crate::estimate::normal_quantile(1.0 - 0.025 / count);
        let largest = |score: f64| {
            bands().map(|b| of_band(b) + score * b.standard.hypot(common)).fold(f64::NEG_INFINITY, f64::max)
        };
        let (low, high) = (largest(-for_all), largest(for_all));
        if !high.is_finite() {
            return Shown::Nothing;
        }
        if low <= 0.0 {
            let value = decibel(largest(crate::estimate::normal_quantile(1.0 - 0.05 / count)).max(0.0));
            return Shown::AtMost(UpperLimit { value, coverage: CLAIM_CONFIDENCE });
        }
        // The largest of many values is too large by about what the bands scatter.
        let middle = largest(0.0).min(0.5 * (low + high)).max(low);
        Shown::Value(decibel(middle), between(low, middle, high, decibel))
    }

    /// The bands up to a frequency, with points between them and at that frequency: there the best model is followed, and what it leaves of the bands
    /// on either side is interpolated.
    fn followed(&self, up_to_hz: f64) -> Vec<Band> {
        let within = |b: &Band| b.frequency_hz <= up_to_hz;
        let Some(model) = self.best().map(|f| &f.model) else { return vec![] };
        let of_model = |f: f64| model.shape(f).norm().ln();
        let left = |b: &Band| b.log_gain - of_model(b.frequency_hz);
        let between = |a: &Band, b: &Band, frequency_hz: f64| {
            let share = ((frequency_hz / a.frequency_hz).ln() / (b.frequency_hz / a.frequency_hz).ln())
                .clamp(0.0, 1.0);
            let log_gain = of_model(frequency_hz) + (1.0 - share) * left(a) + share * left(b);
            let standard = a.standard.max(b.standard).hypot(unsure_between(a, b) * (left(b) - left(a)));
            Band { frequency_hz, log_gain, standard, ..*a }
        };
        let mut all: Vec<Band> = self.bands.iter().copied().filter(within).collect();
        for pair in self.bands.windows(2) {
            let [a, b] = pair else { continue };
            let octaves = (b.frequency_hz / a.frequency_hz).log2();
            let points = (BANDS_PER_OCTAVE * octaves).ceil().max(1.0) as usize;
            let at = |i: usize| a.frequency_hz * 2f64.powf(octaves * i as f64 / points as f64);
            all.extend((1..points).map(|i| between(a, b, at(i))).filter(within));
        }
        let above = self.bands.iter().position(|b| b.frequency_hz > up_to_hz);
        let edge = match above {
            Some(i) => i.checked_sub(1).and_then(|k| self.bands.get(k)).zip(self.bands.get(i)),
            None => self.bands.last().zip(self.bands.last()),
        };
        all.extend(edge.filter(|_| up_to_hz.is_finite()).map(|(a, b)| match above {
            Some(_) => between(a, b, up_to_hz),
            None => Band { frequency_hz: up_to_hz, log_gain: of_model(up_to_hz) + left(a), ..*a },
        }));
        all
    }

    /// What the best model is, for the reader.
    pub fn order(&self) -> Option<Order> {
        self.best().map(|f| f.model.order)
    }
}

/// Standard uncertainty between two bands, as a share of the change from one to the other of what a model leaves: between bands
/// far apart it need not go straight.
fn unsure_between(a: &Band, b: &Band) -> f64 {
    let bands = (b.frequency_hz / a.frequency_hz).log2() * BANDS_PER_OCTAVE;
    0.3 * (bands - 2.0).clamp(0.0, 1.0)
}

/// Decibels of a natural logarithm of a ratio of amplitudes.
pub fn decibel(log_gain: f64) -> f64 {
    20.0 * log_gain / std::f64::consts::LN_10
}

/// A spread with these ends of its interval with 95 %, of a function that rises.
fn between(low: f64, at: f64, high: f64, of: impl Fn(f64) -> f64) -> Spread {
    Spread::by_score(|score| {
        let end = if score < 0.0 { at - low } else { high - at };
        of(at + score / SCORE_TWO_SIDED_95 * end.max(0.0))
    })
}
