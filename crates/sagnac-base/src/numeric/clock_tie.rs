//! Offset and rate between two clocks from a quantity that both record: the angle of a table against the integral of the
//! rate of a gyro, or one temperature twice.
//!
//! With x the slower record at times s of its own clock and f the faster one on the other clock,
//! f(s + o + r (s − s̄)) = c₀ + c₁ s + g x(s) + e. The error e is white noise and a random walk together: noise of an encoder
//! and of the integrated rate, noise of thermometers and what one follows and the other does not. Differences of neighbours
//! have a covariance of three diagonals, so that the likelihood of thousands of samples costs as many steps.
//!
//! Of two thermometers one may lag behind the other, and to first order a lag shifts a record as an offset does. What is left
//! is a part of the second order, τ²/2 f″ for a lag with a time constant τ: where it is seen, the clocks are not tied, and
//! where it is not, the lag that would not be seen is a part of the uncertainty ([`Following::MayLag`]).

mod differences;

use differences::{Instrumental, Whitener, by_instruments, solve};

/// A quantity on one clock: values at increasing times.
#[derive(Debug, Clone, Copy)]
pub struct Timed<'a> {
    /// Times, s.
    pub times_s: &'a [f64],
    /// Values.
    pub values: &'a [f64],
}

/// How the two records follow the quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Following {
    /// Both at once.
    AtOnce,
    /// Either may lag behind the other by a time constant.
    MayLag,
}

/// Offset and rate of a clock against another, with their covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockTie {
    /// Time to add to stamps of the slower record at [`ClockTie::reference_s`], s.
    pub offset_s: f64,
    /// Relative excess of its seconds.
    pub rate: f64,
    /// Middle of its stamps, at which offset and rate are uncorrelated but for the shape of the record, s.
    pub reference_s: f64,
    /// Standard uncertainty of the offset, s.
    pub offset_sd_s: f64,
    /// Standard uncertainty of the rate.
    pub rate_sd: f64,
}

/// Why two clocks cannot be tied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoTie {
    /// Too few samples overlap within the range of the search.
    TooFew,
    /// The quantity does not change in a way that both records show.
    Unrelated,
    /// Several offsets fit nearly as well, as in a motion that repeats itself.
    Ambiguous,
    /// One of the records lags behind the other.
    Lags,
}

/// Fewest samples that tie two clocks.
const MIN_SAMPLES: usize = 16;

/// Most samples of the slower record that offset and rate are fitted to; of a longer record every second, third, ... is taken.
const MAX_SAMPLES: usize = 20_000;

/// Most samples that the offsets of the search are compared by.
const MAX_SEARCH_SAMPLES: usize = 2000;

/// Smallest ratio of the gain to its standard uncertainty at which the records show one quantity.
const MIN_GAIN_RATIO: f64 = 8.0;

/// Log-likelihood by which the best offset must exceed every other peak.
const MIN_LEAD: f64 = 8.0;

/// Largest relative difference of the rates of two clocks.
const MAX_RATE: f64 = 2e-3;

/// Most steps for one ratio of the noises.
const MAX_STEPS: usize = 20;

/// Step that ends them, in standard uncertainties.
const SMALL_STEP: f64 = 0.02;

/// Most times that the ratio of the noises is sought anew.
const MAX_ROUNDS: usize = 4;

/// Longest interval of the faster record that is no gap, in its mean intervals.
const MAX_INTERVALS_APART: f64 = 5.0;

/// Factor between ratios of the noises that are tried.
const RATIO_STEP: f64 = 2.0;

/// Log-likelihood below the best at which a ratio of the noises counts no more.
const RATIO_DEPTH: f64 = 8.0;

/// Samples of the slower record on either side over which slopes are tried.
const REACHES: [usize; 4] = [1, 4, 16, 64];

/// Samples of the slower record between those that bends are taken from.
const BEND_REACH: usize = 2;

/// Smallest share of a slope in one record that the other one shows, times the number of samples.
const MIN_SHOWN: f64 = 50.0;

/// Ratio of the part of the second order to its standard uncertainty from which a lag is seen.
const SEEN_LAG_RATIO: f64 = 4.0;

/// Standard uncertainties above what is found of it up to which that part may go unseen.
const UNSEEN_LAG_RATIO: f64 = 2.0;

/// Offset and rate by which the stamps of `slow` become those of `fast`; offsets up to `range_s` in magnitude are searched.
///
/// # Errors
/// [`NoTie`].
pub fn tie(fast: Timed<'_>, slow: Timed<'_>, range_s: f64, following: Following) -> Result<ClockTie, NoTie> {
    let whole = Model::new(fast, slow, Window { centre_s: 0.0, half_s: range_s }, MAX_SEARCH_SAMPLES)?;
    let start = whole.coarse(range_s)?;
    // About the best offset more of both records overlaps, and every sample counts.
    let step_s = mean_step(slow.times_s);
    let window = Window { centre_s: start.offset_s, half_s: 4.0 * step_s + range_s * 0.01 };
    let model = Model { following, ..Model::new(fast, slow, window, MAX_SAMPLES)? };
    let found = model.averaged(model.likeliest(start).ok_or(NoTie::Unrelated)?)?;
    let inside = (found.offset_s - window.centre_s).abs() < window.half_s && found.rate.abs() < MAX_RATE;
    if inside && found.offset_sd_s.is_finite() { Ok(found) } else { Err(NoTie::Unrelated) }
}

/// Offset, rate, and ratio of the variances of the two kinds of noise, 1/s.
#[derive(Debug, Clone, Copy)]
struct Point {
    offset_s: f64,
    rate: f64,
    ratio: f64,
}

/// Offsets that may be tried.
#[derive(Debug, Clone, Copy)]
struct Window {
    centre_s: f64,
    half_s: f64,
}

/// A fit of all that is linear at a point, with the step to a better one.
struct Fit {
    /// Ratio of the gain to its standard uncertainty.
    gain_ratio: f64,
    /// Share of the slopes in one record that the other one shows, times the number of samples.
    shown: f64,
    /// Step of the offset to a better point, s.
    offset_s: f64,
    /// Step of the rate.
    rate: f64,
    offset_sd_s: f64,
    rate_sd: f64,
    /// Half the square of a time constant with its standard uncertainty, s²; positive where the faster record lags.
    bend_s2: (f64, f64),
}

impl Fit {
    /// The fit of effects in the order of offset, rate, drift, gain and, where one is sought, bend.
    fn of(found: &Instrumental) -> Option<Fit> {
        let value = |i: usize| found.coefficients.get(i).copied();
        let sd = |i: usize| found.standard_deviations.get(i).copied();
        Some(Fit {
            gain_ratio: value(3)?.abs() / sd(3)?,
            shown: found.shown,
            offset_s: value(0).filter(|v| v.is_finite())?,
            rate: value(1).filter(|v| v.is_finite())?,
            offset_sd_s: sd(0)?,
            rate_sd: sd(1)?,
            bend_s2: value(4).zip(sd(4)).unwrap_or_default(),
        })
    }
}

/// The likelihood of a point, all that is linear at its best.
#[derive(Clone, Copy)]
struct Likelihood {
    /// Of the data as they are: compares kinds of noise.
    of_noise: f64,
    /// Against records that have nothing in common: compares offsets, at which the data differ.
    of_place: f64,
}

/// A sample of the slower record: its position, and whether the faster one goes on without a gap from the sample before.
struct Kept {
    index: usize,
    joined: bool,
}

/// Both records at a point.
struct Placed {
    /// The faster one at the stamps of the slower one.
    fast: Vec<f64>,
    slow: Vec<f64>,
}

/// The two records, with the samples of the slower one that the faster one covers at every offset of a window.
struct Model<'a> {
    fast: Timed<'a>,
    slow: Timed<'a>,
    following: Following,
    kept: Vec<Kept>,
    /// Time between neighbours that are joined, s; `None` begins a stretch.
    steps_s: Vec<Option<f64>>,
    reference_s: f64,
    /// Mean interval of the faster record, s.
    interval_s: f64,
}

fn mean_step(times_s: &[f64]) -> f64 {
    times_s.first().zip(times_s.last()).map_or(0.0, |(a, b)| (b - a) / times_s.len().max(2) as f64)
}

impl<'a> Model<'a> {
    fn new(fast: Timed<'a>, slow: Timed<'a>, window: Window, most: usize) -> Result<Model<'a>, NoTie> {
        let interval_s = mean_step(fast.times_s);
        let middle_s = slow.times_s.first().zip(slow.times_s.last()).map_or(0.0, |(a, b)| 0.5 * (a + b));
        let neighbours = fast.times_s.iter().zip(fast.times_s.get(1..).unwrap_or_default());
        let gaps: Vec<(f64, f64)> = neighbours
            .filter(|(a, b)| *b - *a > MAX_INTERVALS_APART * interval_s)
            .map(|(a, b)| (*a, *b))
            .collect();
        let ends = fast.times_s.first().zip(fast.times_s.last()).ok_or(NoTie::TooFew)?;
        // The stretch of the faster record that a sample lies in at every offset, slopes included.
        let stretch = |s: f64| {
            let half_s = window.half_s + MAX_RATE * (s - middle_s).abs() + 2.0 * interval_s;
            let (from, to) = (s + window.centre_s - half_s, s + window.centre_s + half_s);
            let before = gaps.partition_point(|gap| gap.1 <= from);
            let clear = gaps.get(before).is_none_or(|gap| gap.0 >= to);
            (from > *ends.0 && to < *ends.1 && clear).then_some(before)
        };
        let found = slow.times_s.iter().zip(slow.values).enumerate().filter(|(_, (_, v))| v.is_finite());
        let found: Vec<(usize, usize)> = found.filter_map(|(i, (s, _))| Some((i, stretch(*s)?))).collect();
        let thinned = found.iter().step_by(found.len().div_ceil(most).max(1));
        let mut before = None;
        let kept: Vec<Kept> = thinned
            .map(|(index, stretch)| {
                let joined = before.replace(*stretch) == Some(*stretch);
                Kept { index: *index, joined }
            })
            .collect();
        if kept.iter().filter(|k| k.joined).count() + 1 < MIN_SAMPLES {
            return Err(NoTie::TooFew);
        }
        let time = |k: &Kept| slow.times_s.get(k.index).copied().unwrap_or(f64::NAN);
        let pairs = kept.iter().zip(kept.get(1..).unwrap_or_default());
        let steps_s = pairs.map(|(a, b)| b.joined.then(|| time(b) - time(a))).collect();
        let reference_s = kept.iter().map(time).sum::<f64>() / kept.len() as f64;
        Ok(Model { fast, slow, following: Following::AtOnce, kept, steps_s, reference_s, interval_s })
    }

    /// Position of the first sample of the faster record that is not before a time; at least 1.
    fn after(&self, t: f64) -> usize {
        let times = self.fast.times_s;
        let last = times.len().saturating_sub(1).max(1);
        // Stamps are nearly uniform: the place is guessed, and sought only where the guess is wrong.
        let guess = times.first().map_or(0.0, |first| ((t - first) / self.interval_s).ceil());
        let guess = (guess.max(1.0) as usize).min(last);
        let is = |i: usize, before: bool| times.get(i).is_some_and(|x| (*x < t) == before);
        let fits = |i: usize| is(i, false) && i.checked_sub(1).is_some_and(|j| is(j, true));
        let near = [guess, guess + 1, guess.saturating_sub(1)].into_iter().find(|i| fits(*i));
        near.unwrap_or_else(|| times.partition_point(|x| *x < t)).clamp(1, last)
    }

    /// Value of the faster record at a time.
    fn value_at(&self, t: f64) -> f64 {
        let after = self.after(t);
        let pair = |of: &[f64]| Some((*of.get(after - 1)?, *of.get(after)?));
        let (Some((t0, t1)), Some((v0, v1))) = (pair(self.fast.times_s), pair(self.fast.values)) else {
            return f64::NAN;
        };
        v0 + (v1 - v0) * (t - t0) / (t1 - t0)
    }

    /// Stamps of the kept samples.
    fn stamps(&self) -> impl Iterator<Item = f64> + '_ {
        self.kept.iter().map(|k| self.slow.times_s.get(k.index).copied().unwrap_or(f64::NAN))
    }

    /// A stamp of the slower record on the clock of the faster one.
    fn placed_s(&self, at: Point, s: f64) -> f64 {
        s + at.offset_s + at.rate * (s - self.reference_s)
    }

    /// The records at a point, the faster one by its nearest sample: between samples noise averages out, so that some offsets
    /// would fit better than others for that reason alone.
    fn place_roughly(&self, at: Point) -> Placed {
        let nearest = |s: f64| {
            let t = self.placed_s(at, s);
            let after = self.after(t);
            let of = |i: usize| self.fast.times_s.get(i).map(|x| (x - t).abs()).unwrap_or(f64::INFINITY);
            let place = if of(after - 1) < of(after) { after - 1 } else { after };
            self.fast.values.get(place).copied().unwrap_or(f64::NAN)
        };
        let slow =
            self.kept.iter().map(|k| self.slow.values.get(k.index).copied().unwrap_or(f64::NAN)).collect();
        Placed { fast: self.stamps().map(nearest).collect(), slow }
    }

    fn place(&self, at: Point) -> Placed {
        Placed {
            fast: self.stamps().map(|s| self.value_at(self.placed_s(at, s))).collect(),
            slow: self
                .kept
                .iter()
                .map(|k| self.slow.values.get(k.index).copied().unwrap_or(f64::NAN))
                .collect(),
        }
    }

    /// Differences of neighbours that are joined, made independent.
    fn white(&self, noise: &Whitener, values: &[f64]) -> Vec<f64> {
        let pairs = values.iter().zip(values.get(1..).unwrap_or_default()).zip(&self.steps_s);
        noise.whiten(pairs.filter(|(_, step)| step.is_some()).map(|((a, b), _)| b - a).collect())
    }

    /// The likelihood of a point whose records are placed, for one ratio of the noises.
    fn likelihood(&self, placed: &Placed, ratio: f64) -> Option<Likelihood> {
        let noise = Whitener::new(&self.steps_s, ratio);
        let stamps: Vec<f64> = self.stamps().collect();
        let drift = self.white(&noise, &stamps);
        let (data, seen) = (self.white(&noise, &placed.fast), self.white(&noise, &placed.slow));
        let (alone, both) = (solve(&[&drift], &data)?, solve(&[&drift, &seen], &data)?);
        let n = data.len() as f64;
        let half = |squares: f64| -0.5 * n * squares.max(f64::MIN_POSITIVE).ln();
        Some(Likelihood {
            // Restricted: of what the two linear terms leave.
            of_noise: half(both.squares) * (n - 2.0) / n - noise.log_scale
                + 0.5 * both.inverse.determinant().ln(),
            of_place: half(both.squares) - half(alone.squares),
        })
    }

    /// The ratios of the noises that are tried: from a walk that is less over the record than the uncertainty of its mean,
    /// to a walk that is far more from sample to sample than the white noise.
    fn ratios(&self) -> Vec<f64> {
        let n = self.steps_s.len() as f64;
        let length_s: f64 = self.steps_s.iter().flatten().sum();
        let (lowest, highest) = (1.0 / (n * length_s), 100.0 * n / length_s);
        std::iter::successors(Some(lowest), |r| Some(r * RATIO_STEP)).take_while(|r| *r < highest).collect()
    }

    /// The ratio of the noises with the highest likelihood.
    fn likeliest_ratio(&self, placed: &Placed) -> f64 {
        let value = |ratio: &f64| self.likelihood(placed, *ratio).map_or(f64::NEG_INFINITY, |l| l.of_noise);
        let tried = self.ratios().into_iter().map(|r| (r, value(&r)));
        tried.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(1.0, |best| best.0)
    }

    /// Offset and rate, with the ratio of the noises as uncertain as the record leaves it: each ratio counts by its
    /// likelihood.
    fn averaged(&self, at: Point) -> Result<ClockTie, NoTie> {
        let placed = self.place(at);
        let value = |ratio: f64| Some((ratio, self.likelihood(&placed, ratio)?.of_noise));
        let tried: Vec<(f64, f64)> = self.ratios().into_iter().filter_map(value).collect();
        let highest = tried.iter().map(|t| t.1).fold(f64::NEG_INFINITY, f64::max);
        let mut sums = Averages::default();
        for (ratio, value) in tried.into_iter().filter(|t| highest - t.1 < RATIO_DEPTH) {
            let fit = self.fit(Point { ratio, ..at }).ok_or(NoTie::Unrelated)?;
            if !(fit.gain_ratio > MIN_GAIN_RATIO && fit.shown > MIN_SHOWN) {
                return Err(NoTie::Unrelated);
            }
            sums.add((value - highest).exp(), &fit);
        }
        let of = |sums: Option<(f64, f64)>| sums.ok_or(NoTie::Unrelated);
        let ((offset_s, offset_sd_s), (rate, rate_sd)) = (of(sums.of(sums.offset))?, of(sums.of(sums.rate))?);
        Ok(ClockTie {
            offset_s: at.offset_s + offset_s,
            rate: at.rate + rate,
            reference_s: self.reference_s,
            offset_sd_s: offset_sd_s.hypot(self.unseen_lag_s(sums.of(sums.bend))?),
            rate_sd,
        })
    }

    /// Standard uncertainty that a lag which is not seen leaves to the offset, s: it may lie anywhere up to the largest one.
    ///
    /// # Errors
    /// A lag is seen.
    fn unseen_lag_s(&self, bend_s2: Option<(f64, f64)>) -> Result<f64, NoTie> {
        if self.following == Following::AtOnce {
            return Ok(0.0);
        }
        let (value, sd) = bend_s2.ok_or(NoTie::Unrelated)?;
        if value.abs() > SEEN_LAG_RATIO * sd {
            return Err(NoTie::Lags);
        }
        Ok((2.0 * (value.abs() + UNSEEN_LAG_RATIO * sd) / 3.0).sqrt())
    }

    /// The point of the highest likelihood in the range, at equal rates of the clocks.
    fn coarse(&self, range_s: f64) -> Result<Point, NoTie> {
        let step_s = mean_step(self.slow.times_s);
        let count = ((range_s / (0.5 * step_s)).ceil() as i64).clamp(1, 2000);
        let profile = |ratio: f64| -> Vec<(Point, f64)> {
            let of = |i: i64| {
                let point = Point { offset_s: range_s * i as f64 / count as f64, rate: 0.0, ratio };
                let found = self.likelihood(&self.place_roughly(point), ratio);
                (point, found.map_or(f64::NEG_INFINITY, |l| l.of_place))
            };
            (-count..=count).map(of).collect()
        };
        let best_of = |values: &[(Point, f64)]| values.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
        // The kind of noise is found at the best offset for white noise, then the offset anew.
        let (first, _) = best_of(&profile(0.0)).ok_or(NoTie::Unrelated)?;
        let ratio = self.likeliest_ratio(&self.place(first));
        let values = profile(ratio);
        let (best, highest) = best_of(&values).ok_or(NoTie::Unrelated)?;
        let near = 2.0 * range_s / count as f64;
        let rival = values.windows(3).any(|w| match w {
            [a, b, c] => {
                let peak = b.1 >= a.1 && b.1 >= c.1;
                peak && (b.0.offset_s - best.offset_s).abs() > near && highest - b.1 < MIN_LEAD
            }
            _ => false,
        });
        if rival { Err(NoTie::Ambiguous) } else { Ok(best) }
    }

    /// The point of the highest likelihood near another one: Gauss–Newton steps for one ratio of the noises, then the ratio
    /// anew, until it stays.
    fn likeliest(&self, start: Point) -> Option<Point> {
        let mut at = self.converge(start)?;
        for _ in 0..MAX_ROUNDS {
            let ratio = self.likeliest_ratio(&self.place(at));
            if ratio == at.ratio {
                break;
            }
            at = self.converge(Point { ratio, ..at })?;
        }
        Some(at)
    }

    /// Gauss–Newton steps for one ratio of the noises.
    fn converge(&self, start: Point) -> Option<Point> {
        let mut at = start;
        for _ in 0..MAX_STEPS {
            let fit = self.fit(at)?;
            at.offset_s += fit.offset_s;
            at.rate = (at.rate + fit.rate).clamp(-MAX_RATE, MAX_RATE);
            let small = |step: f64, sd: f64| step.abs() < SMALL_STEP * sd;
            if small(fit.offset_s, fit.offset_sd_s) && small(fit.rate, fit.rate_sd) {
                break;
            }
        }
        Some(at)
    }

    /// Least squares by the covariance of the differences, by the reach of the slopes that gives the smallest uncertainty.
    fn fit(&self, at: Point) -> Option<Fit> {
        let noise = Whitener::new(&self.steps_s, at.ratio);
        let placed = self.place(at);
        let stamps: Vec<f64> = self.stamps().collect();
        let fast = |s: &f64| {
            let (t, h) = (self.placed_s(at, *s), self.interval_s);
            -(self.value_at(t + h) - self.value_at(t - h)) / (2.0 * h)
        };
        let [drift, seen, data] = [&stamps, &placed.slow, &placed.fast].map(|v| self.white(&noise, v));
        let gain = *solve(&[&drift, &seen], &data)?.coefficients.get(1)?;
        let bend = (self.following == Following::MayLag).then(|| self.white(&noise, &self.slow_bends(gain)));
        let with = |slopes: &[f64]| -> Vec<Vec<f64>> {
            let turned: Vec<f64> =
                slopes.iter().zip(&stamps).map(|(v, s)| v * (s - self.reference_s)).collect();
            let own = [self.white(&noise, slopes), self.white(&noise, &turned), drift.clone(), seen.clone()];
            own.into_iter().chain(bend.clone()).collect()
        };
        let effects = with(&stamps.iter().map(fast).collect::<Vec<f64>>());
        let tried = REACHES.into_iter().filter_map(|reach| {
            let slopes: Vec<f64> = self.slow_slopes(reach).into_iter().map(|v| -gain * v).collect();
            by_instruments(&effects, &with(&slopes), &data).as_ref().and_then(Fit::of)
        });
        tried.min_by(|a, b| a.offset_sd_s.total_cmp(&b.offset_sd_s))
    }

    /// Slopes of the slower record, the instruments for those of the faster one: the noises of the two are independent, so that
    /// none counts as information, as it would in the square of the slopes of one record. They are taken from as many samples
    /// on both sides: a slope of one side alone would hold the noise of the difference that it explains, and shift the offset.
    fn slow_slopes(&self, reach: usize) -> Vec<f64> {
        let last = self.kept.len().saturating_sub(1);
        let slope = |place: usize| {
            let reach = reach.min(place).min(last - place);
            let ((t0, v0), (t1, v1)) = (self.kept_slow(place - reach)?, self.kept_slow(place + reach)?);
            (reach > 0).then(|| (v1 - v0) / (t1 - t0))
        };
        (0..=last).map(|place| slope(place).unwrap_or(0.0)).collect()
    }

    /// Stamp and value of a kept sample of the slower record.
    fn kept_slow(&self, place: usize) -> Option<(f64, f64)> {
        let index = self.kept.get(place)?.index;
        Some((*self.slow.times_s.get(index)?, *self.slow.values.get(index)?))
    }

    /// Second derivatives of the slower record, times the gain: changes of its slope from before a sample to behind it, the
    /// sample itself left out because its noise is in what they explain.
    fn slow_bends(&self, gain: f64) -> Vec<f64> {
        let of = |place: usize| {
            let [a, b, c, d] = [
                self.kept_slow(place.checked_sub(2 * BEND_REACH)?)?,
                self.kept_slow(place.checked_sub(BEND_REACH)?)?,
                self.kept_slow(place + BEND_REACH)?,
                self.kept_slow(place + 2 * BEND_REACH)?,
            ];
            let (before, behind) = ((b.1 - a.1) / (b.0 - a.0), (d.1 - c.1) / (d.0 - c.0));
            Some(gain * (behind - before) / (0.5 * (d.0 + c.0 - b.0 - a.0)))
        };
        (0..self.kept.len()).map(|place| of(place).unwrap_or(0.0)).collect()
    }
}

/// Weighted sums of steps with their variances.
#[derive(Default)]
struct Averages {
    weight: f64,
    offset: (f64, f64),
    rate: (f64, f64),
    bend: (f64, f64),
}

impl Averages {
    fn add(&mut self, weight: f64, fit: &Fit) {
        let add = |to: &mut (f64, f64), value: f64, sd: f64| {
            to.0 += weight * value;
            to.1 += weight * (value * value + sd * sd);
        };
        self.weight += weight;
        add(&mut self.offset, fit.offset_s, fit.offset_sd_s);
        add(&mut self.rate, fit.rate, fit.rate_sd);
        add(&mut self.bend, fit.bend_s2.0, fit.bend_s2.1);
    }

    /// Mean and standard uncertainty of one of the sums.
    fn of(&self, sums: (f64, f64)) -> Option<(f64, f64)> {
        let mean = sums.0 / self.weight;
        let variance = sums.1 / self.weight - mean * mean;
        (variance > 0.0).then(|| (mean, variance.sqrt()))
    }
}

#[cfg(test)]
#[path = "clock_tie_tests.rs"]
mod tests;
