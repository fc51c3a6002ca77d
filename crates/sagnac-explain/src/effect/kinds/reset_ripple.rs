//! A contribution that is periodic in the sensed angle.

use crate::effect::mean::first;
use crate::effect::shared::heterodyne::{Beat, Sample as AngleSample, Scope, quick_size, strongest};
use crate::effect::shared::reach::varies;
use crate::effect::shared::search::{best_of, fast_level, peaks};
use crate::effect::shared::sinusoid::{averaged, pair, polar, wave};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, number,
};
use crate::numeric::optimize::parabolic_peak;
use crate::numeric::order::SortByNumber;
use crate::numeric::range::{Bounds, ends};
use rayon::prelude::*;
use sagnac_fft::{Complex, Fft, complex_forward};
use std::f64::consts::PI;
use std::sync::Arc;

pub struct ResetRipple;

static PARAMS: [Param; 5] = [
    Param::reported("period_arcsec", "arcsec", 1e-3, 1e7),
    Param::inner("amplitude_deg_h", "deg/h", 0.0, 1e5),
    Param::inner("phase_deg", "deg", -360.0, 360.0),
    Param::inner("sensed_bias_deg_h", "deg/h", -1e5, 1e5),
    // 1: the angle is off, as by resets that are no whole turn of the phase; 0: the rate is.
    Param::inner("of_angle", "", 0.0, 1.0),
];

/// Quantity that comes back with each period of the sensed angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// A contribution to the rate.
    Rate,
    /// An error of the angle, of which the rate shows the change: it grows with the rate.
    Angle,
}

impl Form {
    /// All forms; the position of one is its number among the nonlinear parameters.
    const ALL: [Form; 2] = [Form::Rate, Form::Angle];

    fn of_number(number: f64) -> Form {
        if number > 0.5 { Form::Angle } else { Form::Rate }
    }

    fn number(self) -> f64 {
        if self == Form::Angle { 1.0 } else { 0.0 }
    }

    /// Share of the amplitude that a sample shows which turns by so many periods. Of an error of the angle the amplitude is that of
    /// samples of half a period, which show most.
    fn share(self, periods: f64) -> f64 {
        match self {
            Form::Rate => averaged(periods),
            Form::Angle => (PI * periods).sin(),
        }
    }
}

describe! {
    ResetRipple, "reset_ripple", Mean in Angle, needs [TableRate],
    confusers [Line, TableHarmonic, NoiseVarianceRate]
}

/// Shortest period that is looked for, arcsec.
const MIN_PERIOD_ARCSEC: f64 = 0.5;
/// Most periods of angle in a search.
const MAX_PERIODS: usize = 1 << 18;
/// Most periods for each sample that tells of them: where few samples of a fast table are slow enough, nearly any period fits them.
const MAX_PERIODS_A_SAMPLE: usize = 64;
/// Cells and samples that a search of one octave of periods may go through.
const OCTAVE_BUDGET: f64 = 2e7;
/// Largest departure of the bias from the claimed one, deg/h.
const MAX_BIAS_ERROR_DEG_H: f64 = 100.0;
/// The same where no search of one bias after another would see all that are possible.
const UNCERTAIN_OCTAVE_BUDGET: f64 = 6e7;
/// Standard deviations of the fitted bias within which the true one is sought.
const BIAS_SEARCH_SIGMAS: f64 = 3.0;

/// Sensed angle at the middle of each sample since the first began, and its change over the sample, arcsec.
fn sensed(bias: f64, drivers: &Drivers) -> Option<(Vec<f64>, Vec<f64>)> {
    let rate = drivers.table_rate.as_ref()?;
    let mut angle = 0.0;
    let steps: Vec<f64> = rate.iter().map(|r| (3600.0 * r + bias) * drivers.dt_s).collect();
    let middles = steps.iter().map(|step| {
        angle += step;
        angle - 0.5 * step
    });
    let middles = middles.collect();
    Some((middles, steps))
}

/// Range of the sensed angle, arcsec.
fn extent(bias: f64, drivers: &Drivers) -> f64 {
    sensed(bias, drivers).map_or(1.0, |(angle, _)| {
        let Bounds { low, high } = ends(&angle);
        (high - low).max(1e-9)
    })
}

fn columns(period: f64, bias: f64, form: Form, drivers: &Drivers) -> Vec<Vec<f64>> {
    match sensed(bias, drivers) {
        Some((angle, step)) if period > 0.0 => {
            pair(angle.len(), |i| (angle[i] / period, form.share(step[i] / period)))
        }
        _ => vec![],
    }
}

/// Scores of the samples that cover less than a period, weighted by what a form shows in the middle of the octave of a period; the forms
/// that shape a record alike are one.
struct Weighted {
    samples: Vec<AngleSample>,
    /// Sum of the squares of the weights.
    squares: f64,
}

impl Weighted {
    fn all(
        period: f64,
        (middles, steps): &(Vec<f64>, Vec<f64>),
        context: &SearchContext<'_>,
    ) -> Vec<Weighted> {
        /// Correlation from which two forms are alike to a search.
        const ALIKE_CORRELATION: f64 = 0.9;
        let used: Vec<usize> = (0..steps.len()).filter(|i| steps[*i].abs() < period).collect();
        let weights = |form: Form| -> Vec<f64> {
            let middle = period / Octave::MIDDLE_FREQUENCY;
            used.iter().map(|i| form.share(steps[*i] / middle)).collect()
        };
        let [rate, angle] = Form::ALL.map(weights);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let squares = [product(&rate, &rate), product(&angle, &angle)];
        let alike = product(&rate, &angle).abs() >= ALIKE_CORRELATION * (squares[0] * squares[1]).sqrt();
        let sample = |(number, weight): (&usize, f64)| AngleSample {
            number: *number,
            angle_arcsec: middles[*number],
            score: weight * context.score[*number],
        };
        let forms = [rate, angle].into_iter().zip(squares).take(if alike { 1 } else { Form::ALL.len() });
        forms
            .filter(|(_, squares)| *squares > 0.0)
            .map(|(weights, squares)| Weighted {
                samples: used.iter().zip(weights).map(sample).collect(),
                squares,
            })
            .collect()
    }
}

/// A search of the periods between one and twice that: the score is turned back at the middle of their frequencies, put on
/// a grid of angles a period wide and transformed. Only samples that cover less than a period count.
struct Octave {
    period: f64,
    samples: Vec<Sample>,
    low: f64,
    range: f64,
    dt_s: f64,
    /// Sum of the squares of the weights of the scores.
    squares: f64,
    plan: Arc<dyn Fft<f64>>,
}

/// A sample that counts.
struct Sample {
    /// Since the first of the record.
    number: usize,
    angle_arcsec: f64,
    /// Score, turned back for the angle.
    score: Complex<f64>,
}

/// Buffers of the search for one bias.
#[derive(Default)]
struct Buffers {
    grid: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
    gains: Vec<f64>,
}

impl Octave {
    /// Middle of the frequencies that are looked at, in cycles a period.
    const MIDDLE_FREQUENCY: f64 = 0.75;

    /// `margin` is what biases turn the angle by, arcsec.
    fn new(period: f64, weighted: &Weighted, dt_s: f64, margin: f64) -> Option<Octave> {
        let sample = |&AngleSample { number, angle_arcsec, score }: &AngleSample| {
            let turned = Complex::cis(-2.0 * PI * (Octave::MIDDLE_FREQUENCY * angle_arcsec / period).fract());
            Sample { number, angle_arcsec, score: turned * score }
        };
        let samples: Vec<Sample> = weighted.samples.iter().map(sample).collect();
        let (low, high) = samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| {
            (s.angle_arcsec.min(a), s.angle_arcsec.max(b))
        });
        let (low, high) = (low - margin, high + margin);
        let cells = (high - low) / period;
        let most = MAX_PERIODS.min(MAX_PERIODS_A_SAMPLE * samples.len());
        if samples.len() < 32 || !cells.is_finite() || cells >= most as f64 {
            return None;
        }
        // Twice the range, so that periods between the cycles of the range are seen too.
        let size = quick_size((2 * (cells as usize + 1)).max(8));
        let plan = complex_forward(size);
        Some(Octave { period, samples, low, range: high - low, dt_s, squares: weighted.squares, plan })
    }

    /// Gains for one bias by their frequency into `buffers`; the frequency of the first and the step, cycles an arcsec.
    /// `level` is that of the noise.
    fn gains(&self, bias_deg_h: f64, level: f64, buffers: &mut Buffers) -> (f64, f64) {
        let size = self.plan.len();
        buffers.grid.clear();
        buffers.grid.resize(size, Complex::default());
        // A degree an hour is an arcsecond a second.
        let a_sample = bias_deg_h * self.dt_s;
        let turn = |samples: f64| {
            Complex::cis(-2.0 * PI * (Octave::MIDDLE_FREQUENCY * a_sample * samples / self.period).fract())
        };
        let (next, mut turned, mut expected) = (turn(1.0), Complex::default(), usize::MAX);
        for sample in &self.samples {
            turned = if sample.number == expected { turned * next } else { turn(sample.number as f64) };
            expected = sample.number + 1;
            let at = (sample.angle_arcsec + a_sample * sample.number as f64 - self.low) / self.period;
            if let Some(cell) = buffers.grid.get_mut(at as usize) {
                *cell += sample.score * turned;
            }
        }
        buffers.scratch.resize(self.plan.get_inplace_scratch_len(), Complex::default());
        self.plan.process_with_scratch(&mut buffers.grid, &mut buffers.scratch);
        let step = 1.0 / (size as f64 * self.period);
        let (quarter, middle) = (size / 4, Octave::MIDDLE_FREQUENCY / self.period);
        let scale = level / self.squares;
        let first = middle - quarter as f64 * step;
        let gain = |j: usize| {
            let f = first + j as f64 * step;
            let w = buffers.grid[(j + size - quarter) % size];
            if f * self.range >= 3.0 { w.norm_sqr() * scale } else { 0.0 }
        };
        buffers.gains.clear();
        buffers.gains.extend((0..=2 * quarter).map(gain));
        (first, step)
    }
}

/// A search of the periods between one and twice that over every bias at once, where that is less work than one bias after another: what the
/// table turns is known, so that the bias shows as a beat.
struct Beats<'a> {
    weighted: &'a Weighted,
    scope: Scope,
}

impl Beats<'_> {
    /// `of_table` is the angle that the table turned by at each sample of the record. `None` where more than the budget of samples and
    /// places of transforms would be gone through.
    fn new<'a>(
        period: f64,
        of_table: &[f64],
        weighted: &'a Weighted,
        offset_deg_h: f64,
        budget: f64,
        dt_s: f64,
    ) -> Option<Beats<'a>> {
        let used: Vec<f64> = weighted.samples.iter().map(|s| of_table[s.number]).collect();
        let Bounds { low, high } = ends(&used);
        // A period that is between two of them is a quarter of a turn off at the ends.
        let step = 0.5 / (high - low).max(period);
        // A degree an hour is an arcsecond a second.
        let offset_arcsec_s = offset_deg_h.min(MAX_BIAS_ERROR_DEG_H);
        let frequencies = [0.5 / period, 1.0 / period];
        let scope = Scope { frequencies, step, offset_arcsec_s, dt_s, samples: of_table.len() };
        let affordable = used.len() >= 64 && scope.cost(used.len()) <= budget;
        affordable.then_some(Beats { weighted, scope })
    }

    /// Gains with their period and bias, the largest first.
    fn found(&self, level: f64, fitted_deg_h: f64) -> Vec<(f64, [f64; 2])> {
        /// Beats of an octave that are looked at more closely.
        const CLOSER_BEATS: usize = 4;
        let scale = level / self.weighted.squares;
        let shape = |b: Beat| [1.0 / b.frequency, fitted_deg_h + b.offset_arcsec_s];
        let beats = strongest(&self.weighted.samples, &self.scope, CLOSER_BEATS).into_iter();
        beats.map(|b| (b.power * scale, shape(b))).collect()
    }
}

impl MeanModel for ResetRipple {
    fn applies(&self, drivers: &Drivers) -> bool {
        let slow = |r: &&f64| (3600.0 * **r * drivers.dt_s).abs() < 3600.0;
        varies(drivers.table_rate.as_deref())
            && drivers.table_rate.iter().flatten().filter(slow).count() >= 64
    }

    /// An error of the bias turns the phase along the record: biases within a few turns of the fitted one are tried.
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let n = drivers.samples;
        if n < 64 || !context.is_of(n) {
            return Starts::none();
        }
        let fitted = drivers.claim.bias_deg_h;
        // The mean of a random walk is off from where it began by π²/3 times the variance of its slowest wave.
        let deviation = PI * (context.powers[1] / (3.0 * n as f64)).sqrt();
        let Some(angles) = sensed(fitted, drivers) else { return Starts::none() };
        let Some((of_table, _)) = sensed(0.0, drivers) else { return Starts::none() };
        let Bounds { low, high } = ends(&angles.0);
        let level = fast_level(context);
        let (mut period, mut found, mut trials) = (MIN_PERIOD_ARCSEC, vec![], 1.0);
        while period < (high - low) / 3.0 {
            // Half turns of the phase over the record that the uncertainty of the bias amounts to.
            let uncertain = BIAS_SEARCH_SIGMAS * deviation * drivers.length_s() / (0.5 * period);
            let affordable = 0.5 * OCTAVE_BUDGET / (8.0 * (high - low) / period + n as f64);
            let turns = uncertain.min(affordable).clamp(1.0, 1e4).ceil() as i32;
            let per_turn = 0.5 * period / drivers.length_s();
            let margin = f64::from(turns) * 0.5 * period;
            for weighted in Weighted::all(period, &angles, context) {
                let most = (BIAS_SEARCH_SIGMAS * deviation).max(per_turn);
                let tried = f64::from(2 * turns + 1) * (8.0 * (high - low) / period + n as f64);
                let budget = if uncertain > affordable { UNCERTAIN_OCTAVE_BUDGET } else { tried };
                let beats = Beats::new(period, &of_table, &weighted, most, budget, drivers.dt_s);
                if let Some(beats) = beats {
                    trials += beats.scope.trials();
                    found.extend(beats.found(level, fitted));
                    continue;
                }
                let octave = Octave::new(period, &weighted, drivers.dt_s, margin);
                let Some(octave) = octave else { continue };
                let of_bias = |buffers: &mut Buffers, k: i32| {
                    let other = f64::from(k) * per_turn;
                    let (first, step) = octave.gains(other, level, buffers);
                    let shape = |j: usize| {
                        let f = first + (j as f64 + parabolic_peak(&buffers.gains, j)) * step;
                        (buffers.gains[j], [1.0 / f, fitted + other])
                    };
                    peaks(&buffers.gains, 2, 6).into_iter().map(shape).collect::<Vec<_>>()
                };
                let seen: Vec<Vec<_>> =
                    (-turns..=turns).into_par_iter().map_init(Buffers::default, of_bias).collect();
                trials += seen.len() as f64 * (high - low) / period * 0.5;
                found.extend(seen.into_iter().flatten());
            }
            period *= 2.0;
        }
        found.sort_descending_by(|a| a.0);
        // Forms that are alike to the search need not be so to the likelihood.
        let points = found
            .into_iter()
            .take(6)
            .flat_map(|(_, [period, bias])| Form::ALL.map(|form| vec![period, bias, form.number()]));
        Starts { points: best_of(self, points, 3, drivers, context), trials }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let bias = drivers.claim.bias_deg_h;
        let range = extent(bias, drivers);
        vec![
            Bounds::new(0.5 * MIN_PERIOD_ARCSEC, (0.5 * range).max(MIN_PERIOD_ARCSEC)),
            Bounds::new(bias - MAX_BIAS_ERROR_DEG_H, bias + MAX_BIAS_ERROR_DEG_H),
            Bounds::new(0.0, 1.0),
        ]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let [period, bias, form] = nonlinear_parameters else { return Regressors::default() };
        Regressors::columns(columns(*period, *bias, Form::of_number(*form), drivers))
    }

    fn whole(&self) -> &'static [usize] {
        &[2]
    }

    fn forms(&self) -> Option<(usize, &'static [f64])> {
        Some((2, &[0.0, 1.0]))
    }

    /// The harmonics of a ripple have its cause.
    fn same_cause(&self, earlier: &[f64], nonlinear_parameters: &[f64]) -> bool {
        /// Highest harmonic that is taken for one.
        const HIGHEST_HARMONIC: f64 = 5.0;
        /// Departure of a ratio of periods from a whole number, as a share of it.
        const MAX_DEPARTURE: f64 = 0.01;
        let [one, other] = [first(earlier), first(nonlinear_parameters)];
        let ratio = (one / other).max(other / one);
        let whole = ratio.round();
        whole <= HIGHEST_HARMONIC && (ratio / whole - 1.0).abs() < MAX_DEPARTURE
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        let [period, bias, form] = nonlinear_parameters else { return vec![f64::NAN; PARAMS.len()] };
        let (amplitude, phase) = polar(coefficients);
        vec![*period, amplitude, phase, *bias, *form]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let (period, amplitude) = (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)?);
        let phase = number(values, PARAMS[2].name).unwrap_or(0.0);
        let bias = number(values, PARAMS[3].name).unwrap_or(drivers.claim.bias_deg_h);
        let form = Form::of_number(number(values, PARAMS[4].name).unwrap_or(0.0));
        let columns = columns(period, bias, form, drivers);
        (columns.len() == 2).then(|| wave(amplitude, phase, &columns))
    }

    /// The period of the sensed angle, and the rates at which a sample covers less than one.
    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let [period, bias, _] = nonlinear_parameters else { return vec![] };
        let range = extent(*bias, drivers);
        let half = (0.5 * period * period / range).min(0.25 * period);
        let fastest = period / drivers.dt_s / 3600.0;
        vec![
            Place { domain: Domain::Angle, from: (period - half) / 3600.0, to: (period + half) / 3600.0 },
            Place { domain: Domain::InputRate, from: -fastest, to: fastest },
        ]
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        let range = extent(drivers.claim.bias_deg_h, drivers);
        // A tenth of a cycle over the range for a period of some seconds of arc.
        vec![0.1 * 9.0 / range, 0.1 * 3.0 / drivers.length_s(), 1.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sensed_angle_is_that_of_the_table_and_of_the_bias() {
        // 1 deg/h over 1 s is 1 arcsec.
        let drivers =
            Drivers { dt_s: 2.0, samples: 2, table_rate: Some(vec![0.0, 0.001]), ..Drivers::default() };
        let (middles, steps) = sensed(10.0, &drivers).unwrap();
        assert!((steps[0] - 20.0).abs() < 1e-12 && (steps[1] - 27.2).abs() < 1e-12, "{steps:?}");
        assert!((middles[0] - 10.0).abs() < 1e-12 && (middles[1] - 33.6).abs() < 1e-12, "{middles:?}");
        assert!((extent(10.0, &drivers) - 23.6).abs() < 1e-12);
        assert_eq!(extent(10.0, &Drivers::default()), 1.0);
    }

    #[test]
    fn a_harmonic_is_no_ripple_of_its_own() {
        let same = |one: f64, other: f64| ResetRipple.same_cause(&[one, 0.0, 0.0], &[other, 0.1, 1.0]);
        assert!(same(30.0, 14.98) && same(10.0, 30.1) && same(20.0, 20.0));
        assert!(!same(30.0, 20.0) && !same(30.0, 4.0));
    }

    #[test]
    fn the_angle_that_is_off_shows_as_its_change_over_a_sample() {
        // Samples of a quarter and of three quarters of 40 arcsec, the second one backwards.
        let rate = |arcsec: f64| arcsec / 3600.0;
        let drivers = Drivers {
            dt_s: 1.0,
            samples: 2,
            table_rate: Some(vec![rate(10.0), rate(-30.0)]),
            ..Drivers::default()
        };
        let error = |angle: f64| (2.0 * PI * angle / 40.0 + 0.4).sin();
        // From 0 to 10, then back to −20.
        let changes = [error(10.0) - error(0.0), error(-20.0) - error(10.0)];
        let columns = columns(40.0, 0.0, Form::Angle, &drivers);
        // The change of sin(φ + 0.4) is 2 sin(π s) cos(φ + 0.4) about the middle.
        let of_columns = |i: usize| 2.0 * (0.4f64.cos() * columns[0][i] - 0.4f64.sin() * columns[1][i]);
        assert!((0..2).all(|i| (of_columns(i) - changes[i]).abs() < 1e-12), "{columns:?} {changes:?}");
    }
}
