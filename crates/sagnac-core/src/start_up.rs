//! Start-up of a gyro from switching on: when the first sample and valid data come, and what power it draws.
//!
//! Sources: IEEE Std 952-2020, 12.4 (warm-up and turn-on) and 12.5 (power).

pub mod zones;

use crate::recording::{Channel, Role, SampleBlock, Sink};

/// Most means of the output that are kept: beyond, neighbours are joined.
const MOST_MEANS: usize = 1 << 18;

/// Share of the means at the end whose median is the level that the output settles at.
const SETTLED_SHARE: f64 = 0.2;

/// Length of the blocks by whose scatter the uncertainty of the mean power is told, s.
const POWER_BLOCK_S: f64 = 1.0;

/// Largest whole number that the values of a recording hold exactly, as a power of two.
const EXACT_BITS: i32 = 53;

/// What tells that data are valid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Valid {
    /// Bits of the status word that are all 1.
    Status {
        /// The bits.
        mask: u64,
    },
    /// The output stays within a band about the level that it settles at.
    Band {
        /// Half the width, deg/h.
        half_width_deg_h: f64,
        /// Length of the means that are compared, s.
        average_s: f64,
    },
    /// Nothing is stated.
    Unstated,
}

/// A zone of temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Its middle, degC.
    pub at_deg_c: f64,
    /// Distance from it to either end, degC.
    pub half_width_deg_c: f64,
}

/// The switchings-on in a zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InZone {
    /// How many there are.
    pub starts: usize,
    /// Their mean temperature while on, degC; not a number without one.
    pub temperature_deg_c: f64,
}

/// What a test of the start-up asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct StartUpTest {
    /// Supply voltage from which on the unit is on, V.
    pub on_voltage_v: f64,
    /// Time from switching on to steady power, s.
    pub steady_after_s: f64,
    /// Time from switching on in which the inrush current is sought, s.
    pub inrush_within_s: f64,
    /// What tells that data are valid.
    pub valid: Valid,
    /// Standard uncertainty of the voltage, relative.
    pub voltage_uncertainty: f64,
    /// Standard uncertainty of the current, relative.
    pub current_uncertainty: f64,
    /// Zones of temperature, each with the switchings-on in it; empty: the first switching-on, whatever its temperature.
    pub zones: Vec<Zone>,
}

/// A moment that lies in an interval, or only after a time, s from switching on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Moment {
    /// A time, known to a resolution on each side.
    At {
        /// The time.
        time_s: f64,
        /// The resolution.
        resolution_s: f64,
    },
    /// The recording began after switching on.
    AtLeast(f64),
    /// It did not come.
    Never,
    /// The supply was never on, or is not recorded.
    NoStart,
    /// Nothing tells it.
    Unstated,
}

/// A quantity of the supply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// Value, W or A.
    pub value: f64,
    /// Standard uncertainty.
    pub standard: f64,
    /// True where the recording began after switching on, so that more may have been drawn before.
    pub at_least: bool,
}

/// What the start-up of a channel showed.
#[derive(Debug, Clone, PartialEq)]
pub struct StartUp {
    /// Channel.
    pub channel: String,
    /// Sample interval, s.
    pub interval_s: f64,
    /// The switchings-on of a zone of temperature; `None` where no zones are asked for.
    pub zone: Option<InZone>,
    /// First sample of the output.
    pub first_sample: Moment,
    /// Valid data from then on.
    pub valid_data: Moment,
    /// Mean power in steady state, W.
    pub power_steady: Option<Drawn>,
    /// Largest power of a sample, W.
    pub power_peak: Option<Drawn>,
    /// Largest current after switching on, A.
    pub inrush_current: Option<Drawn>,
}

/// Sums of the power in steady state: of all samples, and of means of blocks.
#[derive(Debug, Clone, Default)]
struct Steady {
    samples: u64,
    sum: f64,
    block: (f64, u64),
    blocks: u64,
    block_sum: f64,
    block_squares: f64,
}

impl Steady {
    fn push(&mut self, watts: f64, samples_per_block: u64) {
        self.samples += 1;
        self.sum += watts;
        self.block = (self.block.0 + watts, self.block.1 + 1);
        if self.block.1 >= samples_per_block {
            let mean = self.block.0 / self.block.1 as f64;
            self.blocks += 1;
            self.block_sum += mean;
            self.block_squares += mean * mean;
            self.block = (0.0, 0);
        }
    }

    /// Mean and its standard uncertainty by the scatter of the blocks.
    fn mean(&self) -> Option<(f64, f64)> {
        if self.samples == 0 {
            return None;
        }
        let (n, mean) = (self.blocks as f64, self.sum / self.samples as f64);
        let spread = if self.blocks > 1 {
            let variance = (self.block_squares - self.block_sum * self.block_sum / n) / (n - 1.0);
            (variance.max(0.0) / n).sqrt()
        } else {
            0.0
        };
        Some((mean, spread))
    }
}

/// Output of a gyro channel since the unit is on.
#[derive(Debug, Clone)]
struct Output {
    slot: usize,
    channel: String,
    first_s: Option<f64>,
    /// Time at the end of each mean and the mean.
    means: Vec<(f64, f64)>,
    sum: (f64, u64),
}

/// Collects the start-up while a recording goes by.
pub struct StartUpCollector {
    test: StartUpTest,
    interval_s: f64,
    begin_s: Option<f64>,
    supply: Option<usize>,
    current: Option<usize>,
    status: Option<usize>,
    last_off_s: Option<f64>,
    on_s: Option<f64>,
    outputs: Vec<Output>,
    samples_per_mean: u64,
    valid_since_s: Option<f64>,
    steady: Steady,
    peak_w: Option<f64>,
    inrush_a: Option<f64>,
}

impl StartUpCollector {
    /// For the channels of a recording.
    pub fn new(test: StartUpTest, channels: &[Channel], interval_s: f64) -> StartUpCollector {
        let slot = |role: Role| channels.iter().position(|c| c.role == role);
        let gyros = channels.iter().enumerate().filter(|(_, c)| c.role.is_gyro());
        let output = |(slot, c): (usize, &Channel)| Output {
            slot,
            channel: c.id.clone(),
            first_s: None,
            means: vec![],
            sum: (0.0, 0),
        };
        let average_s = match test.valid {
            Valid::Band { average_s, .. } => average_s,
            _ => interval_s,
        };
        StartUpCollector {
            test,
            interval_s,
            begin_s: None,
            supply: slot(Role::Supply),
            current: slot(Role::Current),
            status: slot(Role::Status),
            last_off_s: None,
            on_s: None,
            outputs: gyros.map(output).collect(),
            samples_per_mean: ((average_s / interval_s).round() as u64).max(1),
            valid_since_s: None,
            steady: Steady::default(),
            peak_w: None,
            inrush_a: None,
        }
    }

    /// One sample at a time of the recording, s; `value` reads a channel.
    fn sample(&mut self, time_s: f64, value: impl Fn(usize) -> Option<f64>) {
        self.begin_s.get_or_insert(time_s);
        let volts = self.supply.and_then(&value).filter(|v| v.is_finite());
        if self.on_s.is_none() {
            match volts {
                Some(v) if v >= self.test.on_voltage_v => self.on_s = Some(time_s),
                Some(_) => self.last_off_s = Some(time_s),
                None => {}
            }
        }
        let Some(on_s) = self.on_s else { return };
        self.power(time_s - on_s, volts, self.current.and_then(&value).filter(|v| v.is_finite()));
        if let Valid::Status { mask } = self.test.valid {
            let word = self.status.and_then(&value).filter(|w| w.abs() < 2f64.powi(EXACT_BITS));
            // A word with a sign stands for its two's complement.
            let bits = word.map(|w| if w < 0.0 { w as i64 as u64 } else { w as u64 });
            match bits {
                Some(bits) if bits & mask == mask => {
                    self.valid_since_s.get_or_insert(time_s);
                }
                _ => self.valid_since_s = None,
            }
        }
        let keeps = matches!(self.test.valid, Valid::Band { .. });
        for output in &mut self.outputs {
            let Some(rate) = value(output.slot).filter(|v| v.is_finite()) else { continue };
            output.first_s.get_or_insert(time_s);
            output.sum = (output.sum.0 + rate, output.sum.1 + 1);
            if keeps && output.sum.1 >= self.samples_per_mean {
                output.means.push((time_s, output.sum.0 / output.sum.1 as f64));
                output.sum = (0.0, 0);
            }
        }
        if self.outputs.iter().any(|o| o.means.len() >= MOST_MEANS) {
            self.join_means();
        }
    }

    fn power(&mut self, since_on_s: f64, volts: Option<f64>, amperes: Option<f64>) {
        let Some(amperes) = amperes else { return };
        if since_on_s <= self.test.inrush_within_s {
            self.inrush_a = Some(self.inrush_a.map_or(amperes, |most| most.max(amperes)));
        }
        let Some(watts) = volts.map(|v| v * amperes) else { return };
        self.peak_w = Some(self.peak_w.map_or(watts, |most| most.max(watts)));
        if since_on_s >= self.test.steady_after_s {
            let samples_per_block = ((POWER_BLOCK_S / self.interval_s).round() as u64).max(1);
            self.steady.push(watts, samples_per_block);
        }
    }

    /// Joins neighbouring means, so that any length takes as much memory.
    fn join_means(&mut self) {
        self.samples_per_mean *= 2;
        for output in &mut self.outputs {
            let joined = output.means.chunks_exact(2).filter_map(|pair| match pair {
                [a, b] => Some((b.0, 0.5 * (a.1 + b.1))),
                _ => None,
            });
            output.means = joined.collect();
        }
    }

    /// What was found, for every gyro channel. `interval_s` is the measured interval.
    pub fn finish(self, interval_s: f64) -> Vec<StartUp> {
        let of = |output: &Output| StartUp {
            channel: output.channel.clone(),
            interval_s,
            zone: None,
            first_sample: self.moment(output.first_s, interval_s),
            valid_data: match self.test.valid {
                Valid::Unstated => Moment::Unstated,
                Valid::Status { .. } if self.status.is_none() => Moment::Unstated,
                Valid::Status { .. } => self.moment(self.valid_since_s, interval_s),
                Valid::Band { half_width_deg_h, .. } => {
                    let resolution_s = self.samples_per_mean as f64 * interval_s;
                    self.moment(settled(&output.means, half_width_deg_h), resolution_s)
                }
            },
            power_steady: self.steady.mean().map(|(value, spread)| Drawn {
                value,
                standard: spread.hypot(value * self.relative()),
                at_least: false,
            }),
            power_peak: self.peak_w.map(|value| self.drawn(value, self.relative())),
            inrush_current: self.inrush_a.map(|value| self.drawn(value, self.test.current_uncertainty)),
        };
        self.outputs.iter().map(of).collect()
    }

    /// Relative standard uncertainty of a power.
    fn relative(&self) -> f64 {
        self.test.voltage_uncertainty.hypot(self.test.current_uncertainty)
    }

    fn drawn(&self, value: f64, relative: f64) -> Drawn {
        Drawn { value, standard: relative * value.abs(), at_least: self.last_off_s.is_none() }
    }

    /// A time of the recording from switching on.
    fn moment(&self, time_s: Option<f64>, resolution_s: f64) -> Moment {
        let (Some(on_s), Some(begin_s)) = (self.on_s, self.begin_s) else { return Moment::NoStart };
        match (time_s, self.last_off_s) {
            (None, _) => Moment::Never,
            (Some(time), Some(off_s)) => {
                Moment::At { time_s: time - on_s, resolution_s: resolution_s.max(on_s - off_s) }
            }
            (Some(time), None) => Moment::AtLeast((time - begin_s - resolution_s).max(0.0)),
        }
    }
}

/// The time of the first mean from which on all lie within the band about the level at the end; `None` where there are too few.
fn settled(means: &[(f64, f64)], half_width: f64) -> Option<f64> {
    let count = ((SETTLED_SHARE * means.len() as f64).ceil() as usize).max(1);
    let mut last: Vec<f64> = means.iter().rev().take(count).map(|m| m.1).collect();
    last.sort_by(f64::total_cmp);
    let level = last.get(last.len() / 2).copied()?;
    let outside = means.iter().rposition(|m| (m.1 - level).abs() > half_width);
    let first_inside = outside.map_or(0, |i| i + 1);
    // A record whose very end leaves the band has not settled.
    (first_inside + count <= means.len()).then(|| means.get(first_inside).map(|m| m.0)).flatten()
}

impl Sink for StartUpCollector {
    fn push(&mut self, block: &SampleBlock<'_>) {
        let rows = block.values.first().map_or(0, Vec::len);
        for i in 0..rows {
            let time_s = block.time_s + i as f64 * self.interval_s;
            self.sample(time_s, |slot| block.values.get(slot).and_then(|v| v.get(i)).copied());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::ColumnRef;
    use crate::units::Unit;

    fn channels() -> Vec<Channel> {
        let of = |(at, (id, role)): (usize, (&str, Role))| Channel {
            id: id.into(),
            column: ColumnRef::Position(at + 1),
            role,
            unit: Unit::pure(),
            scale: 1.0,
        };
        let roles = [("x", Role::Rate), ("v", Role::Supply), ("i", Role::Current), ("status", Role::Status)];
        roles.into_iter().enumerate().map(of).collect()
    }

    fn test() -> StartUpTest {
        StartUpTest {
            on_voltage_v: 3.0,
            steady_after_s: 5.0,
            inrush_within_s: 1.0,
            valid: Valid::Status { mask: 1 },
            voltage_uncertainty: 0.001,
            current_uncertainty: 0.002,
            zones: vec![],
        }
    }

    /// A record at 10 Hz of 20 s with power from `on` s on: output after 0.5 s, valid after 3 s, 2 A at first, then 0.4 A.
    fn record(test: StartUpTest, on_s: f64) -> StartUp {
        let mut collector = StartUpCollector::new(test, &channels(), 0.1);
        let mut values = vec![vec![]; 4];
        for i in 0..200 {
            let since = f64::from(i) * 0.1 - on_s;
            let is_on = since > -1e-9;
            values[0].push(if since > 0.5 - 1e-9 { 1.0 + 10.0 * (-since).exp() } else { f64::NAN });
            values[1].push(if is_on { 5.0 } else { 0.0 });
            values[2].push(if !is_on {
                0.0
            } else if since < 0.2 {
                2.0
            } else {
                0.4
            });
            values[3].push(if since > 3.0 - 1e-9 { 3.0 } else { 2.0 });
        }
        let block =
            SampleBlock { first_index: 0, first_row: 1, time_s: 100.0, continues: false, values: &values };
        collector.push(&block);
        collector.finish(0.1).remove(0)
    }

    #[test]
    fn times_are_counted_from_the_edge_of_the_supply() {
        let found = record(test(), 2.0);
        let at = |moment: Moment| match moment {
            Moment::At { time_s, resolution_s } => (time_s, resolution_s),
            other => panic!("{other:?}"),
        };
        assert!((at(found.first_sample).0 - 0.5).abs() < 1e-9);
        assert!((at(found.valid_data).0 - 3.0).abs() < 1e-9 && (at(found.valid_data).1 - 0.1).abs() < 1e-9);
        let steady = found.power_steady.unwrap();
        assert!((steady.value - 2.0).abs() < 1e-12 && (steady.standard / 2.0 - 0.002_236).abs() < 1e-5);
        assert_eq!(found.power_peak.map(|p| (p.value, p.at_least)), Some((10.0, false)));
        assert_eq!(found.inrush_current.map(|p| p.value), Some(2.0));
    }

    #[test]
    fn a_record_that_begins_later_gives_bounds_only() {
        let found = record(test(), -1.0);
        assert_eq!(found.first_sample, Moment::AtLeast(0.0));
        assert!(matches!(found.valid_data, Moment::AtLeast(s) if (s - 1.9).abs() < 1e-9));
        assert!(found.inrush_current.unwrap().at_least);
        assert_eq!(record(test(), 100.0).first_sample, Moment::NoStart);
    }

    #[test]
    fn a_band_tells_when_the_output_has_settled() {
        let band = Valid::Band { half_width_deg_h: 0.1, average_s: 0.1 };
        let found = record(StartUpTest { valid: band, ..test() }, 2.0);
        // 10·e^(−t) falls to 0.1 after ln 100 = 4.605 s.
        assert!(matches!(found.valid_data, Moment::At { time_s, .. } if (time_s - 4.65).abs() < 0.11));
        let never = Valid::Band { half_width_deg_h: 1e-12, average_s: 0.1 };
        assert_eq!(record(StartUpTest { valid: never, ..test() }, 2.0).valid_data, Moment::Never);
        let unstated = StartUpTest { valid: Valid::Unstated, ..test() };
        assert_eq!(record(unstated, 2.0).valid_data, Moment::Unstated);
    }
}
