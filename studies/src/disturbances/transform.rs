//! Disturbances of a recording: functions from columns to columns, which import nothing of the analysis.

use crate::bench::noise_source::{NoiseSource, csv};
use serde::Deserialize;
use std::f64::consts::{PI, SQRT_2};

/// Columns that hold the output of a gyroscope.
const OUTPUTS: [&str; 4] = ["rate_deg_h", "rate_deg_s", "x_deg_h", "y_deg_h"];
/// Median of the absolute value of a standard normal deviate.
const MEDIAN_DEVIATE: f64 = 0.674_489_75;
/// A distance of rows longer than so many of the first is a pause.
const PAUSE: f64 = 1.5;

/// A change of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Disturbance {
    /// Nothing: another effect of the unit is large.
    OtherEffect,
    /// The output follows its stimulus late, with a time constant.
    Response { tau_s: f64 },
    /// Output of a loop with a resonance at a share of the sample rate.
    Resonance { at: f64, quality: f64 },
    /// Butterworth low-pass of even order; the cut-off is a share of the sample rate.
    Filter { order: usize, cut_off: f64 },
    /// The output is rounded to steps; the noise of a sample is so many steps.
    Rounded { noise_steps: f64 },
    /// The temperature is rounded to steps, degC.
    Thermometer { step: f64 },
    /// The output rises at a share of the recording, by so many standard deviations of a sample.
    Jump { at: f64, sigmas: f64 },
    /// The output switches to and fro by so many standard deviations, after so many samples in the mean.
    Telegraph { sigmas: f64, dwell: f64 },
    /// A moving mean over a share of the recording is taken out; the mean of all stays.
    DriftRemoved { share: f64 },
}

/// The quantity that the output of a unit follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stimulus<'a> {
    /// Column of the stimulus.
    pub column: &'a str,
    /// Power of the stimulus that the output follows.
    pub power: i32,
    /// Output per unit of that power, deg/h.
    pub effect: f64,
}

/// Columns of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    header: String,
    values: Vec<Vec<f64>>,
}

impl Columns {
    /// Reads the text of a recording; absent where a cell is no number.
    pub fn read(text: &str) -> Option<Columns> {
        let mut lines = text.lines();
        let header = lines.next()?.to_owned();
        let mut values = vec![vec![]; header.split(',').count()];
        for line in lines {
            for (column, cell) in values.iter_mut().zip(line.split(',')) {
                column.push(cell.parse().ok()?);
            }
        }
        Some(Columns { header, values })
    }

    /// Text of the recording.
    pub fn text(&self) -> String {
        csv(&self.header, &self.values.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    fn column(&self, name: &str) -> Option<&[f64]> {
        let at = self.header.split(',').position(|n| n == name)?;
        Some(&self.values[at])
    }

    /// The same recording with one kind of column changed, each stretch without a pause by itself.
    fn with(mut self, names: &[&str], change: impl Fn(&[f64]) -> Vec<f64>) -> Columns {
        let ends = self.ends();
        for (name, values) in self.header.split(',').zip(&mut self.values) {
            if names.contains(&name) {
                let starts = std::iter::once(&0).chain(&ends);
                *values = starts.zip(&ends).flat_map(|(start, end)| change(&values[*start..*end])).collect();
            }
        }
        self
    }

    /// Rows at which stretches without a pause end.
    fn ends(&self) -> Vec<usize> {
        let rows = self.values.first().map_or(0, Vec::len);
        let time = self.column("time_s").unwrap_or_default();
        let pause = time.get(1).map_or(f64::INFINITY, |second| PAUSE * (second - time[0]));
        let mut ends: Vec<usize> =
            (1..time.len()).filter(|row| time[*row] - time[*row - 1] > pause).collect();
        ends.push(rows);
        ends
    }

    /// The recording with a disturbance; absent where it has no column to disturb.
    pub fn disturbed(
        self,
        by: Disturbance,
        stimulus: Option<Stimulus<'_>>,
        source: &mut NoiseSource,
    ) -> Option<Columns> {
        let rows = self.values.first().map_or(0, Vec::len);
        let output = OUTPUTS.iter().find_map(|name| self.column(name))?;
        let sigma = noise(output);
        let added = match by {
            Disturbance::OtherEffect => return Some(self),
            Disturbance::Resonance { at, quality } => {
                return Some(self.with(&OUTPUTS, |x| low_pass(x, at, &[quality])));
            }
            Disturbance::Filter { order, cut_off } => {
                return Some(self.with(&OUTPUTS, |x| low_pass(x, cut_off, &butterworth(order))));
            }
            Disturbance::Rounded { noise_steps } => {
                let step = sigma / noise_steps;
                return Some(self.with(&OUTPUTS, |x| rounded(x, step)));
            }
            Disturbance::Thermometer { step } => {
                self.column("temp_degC")?;
                return Some(self.with(&["temp_degC"], |x| rounded(x, step)));
            }
            Disturbance::Response { tau_s } => late(&self, stimulus?, tau_s)?,
            Disturbance::Jump { at, sigmas } => {
                let first = (at * rows as f64) as usize;
                (0..rows).map(|row| if row < first { 0.0 } else { sigmas * sigma }).collect()
            }
            Disturbance::Telegraph { sigmas, dwell } => telegraph(0.5 * sigmas * sigma, dwell, rows, source),
            Disturbance::DriftRemoved { share } => {
                let (slow, mean) = (moving_mean(output, share), mean(output));
                slow.iter().map(|s| mean - s).collect()
            }
        };
        Some(self.plus(&added))
    }

    /// The recording with something added to the first output.
    fn plus(mut self, added: &[f64]) -> Columns {
        let output = self.header.split(',').position(|name| OUTPUTS.contains(&name));
        if let Some(at) = output {
            crate::bench::noise_source::add(&mut self.values[at], added);
        }
        self
    }
}

/// Standard deviation of the noise of a sample, from the median difference of neighbours.
fn noise(x: &[f64]) -> f64 {
    let mut differences: Vec<f64> = x.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    differences.sort_by(f64::total_cmp);
    differences.get(differences.len() / 2).map_or(0.0, |median| median / (SQRT_2 * MEDIAN_DEVIATE))
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

fn rounded(x: &[f64], step: f64) -> Vec<f64> {
    x.iter().map(|x| step * (x / step).round()).collect()
}

/// Qualities of the sections of a Butterworth filter of even order.
fn butterworth(order: usize) -> Vec<f64> {
    (0..order / 2).map(|k| 0.5 / (PI * (2 * k + 1) as f64 / (2 * order) as f64).cos()).collect()
}

/// Low-pass sections of second order in series, by the bilinear transform, led in by the mirror image of the start.
fn low_pass(x: &[f64], cut_off: f64, qualities: &[f64]) -> Vec<f64> {
    let lead = x.len().saturating_sub(1);
    let mut y: Vec<f64> = x.iter().skip(1).rev().chain(x).copied().collect();
    let k = (PI * cut_off).tan();
    for quality in qualities {
        let scale = 1.0 / (1.0 + k / quality + k * k);
        let (b, a1, a2) = (k * k * scale, 2.0 * (k * k - 1.0) * scale, (1.0 - k / quality + k * k) * scale);
        let start = y.first().copied().unwrap_or(0.0);
        let ([mut x1, mut x2], [mut y1, mut y2]) = ([start; 2], [start; 2]);
        for value in &mut y {
            let now = *value;
            *value = b * (now + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, now, y1, *value);
        }
    }
    y.split_off(lead)
}

/// Difference of an output that follows its stimulus late from one that follows at once.
fn late(columns: &Columns, stimulus: Stimulus<'_>, tau_s: f64) -> Option<Vec<f64>> {
    let (time, level) = (columns.column("time_s")?, columns.column(stimulus.column)?);
    let keep = (-(time.get(1)? - time.first()?) / tau_s).exp();
    let mut followed = level.first()?.powi(stimulus.power);
    let each = level.iter().map(|level| {
        let now = level.powi(stimulus.power);
        followed = keep * followed + (1.0 - keep) * now;
        stimulus.effect * (followed - now)
    });
    Some(each.collect())
}

fn telegraph(half: f64, dwell: f64, rows: usize, source: &mut NoiseSource) -> Vec<f64> {
    let mut level = if source.uniform(0.0, 1.0) < 0.5 { half } else { -half };
    (0..rows)
        .map(|_| {
            if source.uniform(0.0, 1.0) < 1.0 / dwell {
                level = -level;
            }
            level
        })
        .collect()
}

/// Mean about each row over a share of the rows, fewer at the ends.
fn moving_mean(x: &[f64], share: f64) -> Vec<f64> {
    let half = (0.5 * share * x.len() as f64) as usize;
    let mut sums = vec![0.0];
    sums.extend(x.iter().scan(0.0, |sum, x| {
        *sum += x;
        Some(*sum)
    }));
    let about = |i: usize| (i.saturating_sub(half), (i + half + 1).min(x.len()));
    (0..x.len()).map(about).map(|(from, to)| (sums[to] - sums[from]) / (to - from) as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Columns {
        let mut source = NoiseSource::new(3);
        let values = vec![
            (0..4000).map(f64::from).collect(),
            source.white(0.01, 1.0, 4000).iter().map(|x| 12.5 + x).collect(),
            (0..4000).map(|i| 20.0 + 1e-3 * f64::from(i)).collect(),
            (0..4000).map(|i| if i < 1000 { 0.0 } else { 2.0 }).collect(),
        ];
        Columns { header: "time_s,rate_deg_h,temp_degC,level".into(), values }
    }

    fn output(by: Disturbance) -> Vec<f64> {
        let stimulus = Stimulus { column: "level", power: 2, effect: 3.0 };
        let disturbed = recording().disturbed(by, Some(stimulus), &mut NoiseSource::new(5)).unwrap();
        assert_eq!(disturbed.values[0], recording().values[0]);
        disturbed.values[1].clone()
    }

    fn added(by: Disturbance) -> Vec<f64> {
        output(by).iter().zip(&recording().values[1]).map(|(y, x)| y - x).collect()
    }

    #[test]
    fn a_recording_is_written_as_it_was_read() {
        let text = recording().text();
        assert_eq!(Columns::read(&text).unwrap().text(), text);
        assert_eq!(Columns::read("rate_deg_h\nnothing\n"), None);
    }

    #[test]
    fn a_filter_keeps_the_mean_and_has_half_the_power_at_its_cut_off() {
        for order in [2, 4] {
            let y = output(Disturbance::Filter { order, cut_off: 0.05 });
            assert!((mean(&y) - 12.5).abs() < 0.03, "{}", mean(&y));
            let wave = |at: f64| (0..4000).map(|i| (2.0 * PI * at * f64::from(i)).sin()).collect::<Vec<_>>();
            let power = |x: &[f64]| x[2000..].iter().map(|x| x * x).sum::<f64>() / 1000.0;
            let (at, beyond) = (power(&low_pass(&wave(0.05), 0.05, &butterworth(order))), 0.1);
            assert!((at - 0.5).abs() < 1e-3, "{at}");
            let far = power(&low_pass(&wave(beyond), 0.05, &butterworth(order)));
            assert!(far < 1.1 / (1.0 + (beyond / 0.05f64).powi(2 * order as i32)), "{far}");
        }
        let loop_power = |at: f64| mean(&output(Disturbance::Resonance { at, quality: 5.0 }));
        assert!((loop_power(0.1) - 12.5).abs() < 0.03);
    }

    #[test]
    fn a_jump_is_where_it_is_and_a_telegraph_signal_has_two_levels() {
        let sigma = noise(&recording().values[1]);
        assert!((sigma / 0.6 - 1.0).abs() < 0.06, "{sigma}");
        let jump = added(Disturbance::Jump { at: 0.55, sigmas: 2.0 });
        assert!(jump[2199].abs() < 1e-9 && (jump[2200] - 2.0 * sigma).abs() < 1e-9);
        let telegraph = added(Disturbance::Telegraph { sigmas: 2.0, dwell: 50.0 });
        assert!(telegraph.iter().all(|t| (t.abs() - sigma).abs() < 1e-9));
        let turns = telegraph.windows(2).filter(|w| w[0] * w[1] < 0.0).count();
        assert!((55..110).contains(&turns), "{turns}");
    }

    #[test]
    fn what_is_rounded_lies_on_a_grid() {
        let step = noise(&recording().values[1]) / 0.3;
        for x in output(Disturbance::Rounded { noise_steps: 0.3 }) {
            assert!((x / step - (x / step).round()).abs() < 1e-9);
        }
        let by = Disturbance::Thermometer { step: 0.5 };
        let disturbed = recording().disturbed(by, None, &mut NoiseSource::new(5)).unwrap();
        assert!(disturbed.values[2].iter().all(|t| (2.0 * t).fract() == 0.0));
        assert_eq!(disturbed.values[1], recording().values[1]);
    }

    #[test]
    fn a_late_response_arrives_in_the_end_and_a_drift_goes() {
        let late = added(Disturbance::Response { tau_s: 60.0 });
        // A square of four, thrice: a time constant later 1/e of it is missing.
        assert!(late[999].abs() < 1e-9 && (late[1059] + 12.0 / 1f64.exp()).abs() < 1e-6, "{}", late[1059]);
        assert!(late[3999].abs() < 1e-6);
        let ramp: Vec<f64> = (0..1000).map(f64::from).collect();
        let slow = moving_mean(&ramp, 0.1);
        assert!((slow[500] - 500.0).abs() < 1e-9 && slow[0] > 0.0);
    }

    #[test]
    fn a_filter_starts_anew_after_a_pause() {
        let mut columns = recording();
        columns.values[0].iter_mut().skip(2000).for_each(|t| *t += 600.0);
        columns.values[1] = (0..4000).map(|i| if i < 2000 { 1.0 } else { 5.0 }).collect();
        let by = Disturbance::Filter { order: 4, cut_off: 0.05 };
        let y = columns.clone().disturbed(by, None, &mut NoiseSource::new(5)).unwrap();
        assert!(y.values[1].iter().zip(&columns.values[1]).all(|(y, x)| (y - x).abs() < 1e-9));
    }
}
