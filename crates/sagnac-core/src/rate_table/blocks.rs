//! A recording on a rate table, averaged over short blocks: bounded in memory at any length.

use crate::recording::{Channel, Role, SampleBlock, Sink, sensor};

/// Blocks are joined in pairs beyond this number.
const MOST_BLOCKS: usize = 1 << 17;

/// Length of a block to begin with, s.
const BLOCK_S: f64 = 0.1;

/// Arc seconds in a turn.
pub const TURN_ARCSEC: f64 = 1_296_000.0;

/// One block: consecutive samples without a gap inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Position of its first sample on the grid of the recording.
    pub first_index: u64,
    /// Row of its first sample in the recording, counted from 1.
    pub first_row: u64,
    /// Samples.
    pub samples: u32,
    /// True when it follows the block before without a gap.
    pub continues: bool,
    /// Mean output of every gyro channel, deg/h; NaN where none can be used.
    pub gyro: Vec<f64>,
    /// Mean of the rate channel of the table, deg/h; NaN without one.
    pub table_rate: f64,
    /// Mean rate of the other axis, deg/h; NaN without such a channel.
    pub outer_rate: f64,
    /// Mean temperature, degC; NaN without one.
    pub temperature: f64,
    /// Means of the channels kept beside, in the order asked for; NaN where none can be used.
    pub beside: Vec<f64>,
    /// Angle of the table at the first sample, unwrapped, arcsec; NaN without one.
    pub angle_first: f64,
    /// The same at the last sample.
    pub angle_last: f64,
}

/// The blocks of a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Blocks {
    /// The blocks in order.
    pub list: Vec<Block>,
    /// Sample interval, s.
    pub interval_s: f64,
    /// Ids of the gyro channels, in the order of [`Block::gyro`].
    pub gyros: Vec<String>,
    /// True when the angle of the table was recorded.
    pub has_angle: bool,
    /// True when the rate of the table was recorded.
    pub has_rate: bool,
    /// True when a temperature was recorded.
    pub has_temperature: bool,
    /// True when the rate of the other axis was recorded.
    pub has_outer: bool,
}

impl Blocks {
    /// Frees the temperature of the steps and the noise of its thermometer: noise at constant temperature is no range of it.
    #[must_use]
    pub fn with_freed_temperature(mut self) -> Blocks {
        let known = |b: &&mut Block| b.temperature.is_finite();
        let readings: Vec<f64> = self.list.iter().map(|b| b.temperature).filter(|t| t.is_finite()).collect();
        let freed = if sensor::is_steady(&readings) {
            let mean = readings.iter().sum::<f64>() / readings.len() as f64;
            vec![mean; readings.len()]
        } else if let Some(course) = sensor::between_steps(&readings) {
            course
        } else {
            return self;
        };
        for (block, value) in self.list.iter_mut().filter(known).zip(freed) {
            block.temperature = value;
        }
        self
    }

    /// Time of the start of a block, s from the start of the recording.
    pub fn start_s(&self, at: usize) -> f64 {
        self.list.get(at).map_or(0.0, |b| b.first_index as f64 * self.interval_s)
    }
}

/// Collects blocks.
pub struct Collector {
    slots: Slots,
    blocks: Blocks,
    per_block: u32,
    open: Option<Open>,
    angle: Option<(f64, u64)>,
    cumulative: bool,
}

struct Slots {
    gyros: Vec<usize>,
    rate: Option<usize>,
    angle: Option<usize>,
    outer: Option<usize>,
    temperature: Option<usize>,
    beside: Vec<usize>,
}

/// A block that is being filled: sums and counts.
struct Open {
    block: Block,
    counts: Vec<u32>,
    others: [(f64, u32); 3],
    beside: Vec<u32>,
}

impl Collector {
    /// Prepares for the channels of a recording; `temperature` names the channel of the unit's temperature, otherwise
    /// the first is taken.
    pub fn new(channels: &[Channel], interval_s: f64, temperature: Option<&str>) -> Collector {
        let first = |role: Role| channels.iter().position(|c| c.role == role);
        let gyros: Vec<usize> = (0..channels.len()).filter(|i| channels[*i].role.is_gyro()).collect();
        let slots = Slots {
            rate: first(Role::TableRate),
            angle: first(Role::TableAngle),
            outer: first(Role::OuterRate),
            temperature: temperature
                .and_then(|id| channels.iter().position(|c| c.id == id))
                .or_else(|| first(Role::Temperature)),
            gyros,
            beside: vec![],
        };
        let blocks = Blocks {
            interval_s,
            gyros: slots.gyros.iter().map(|i| channels[*i].id.clone()).collect(),
            has_angle: slots.angle.is_some(),
            has_rate: slots.rate.is_some(),
            has_temperature: slots.temperature.is_some(),
            has_outer: slots.outer.is_some(),
            ..Blocks::default()
        };
        let per_block = (BLOCK_S / interval_s).round().clamp(1.0, 1e6) as u32;
        Collector { slots, blocks, per_block, open: None, angle: None, cumulative: false }
    }

    /// Blocks of one sample to begin with, for stretches whose ends matter.
    #[must_use]
    pub fn fine(mut self) -> Collector {
        self.per_block = 1;
        self
    }

    /// Keeps the means of further channels, by their positions.
    #[must_use]
    pub fn beside(mut self, slots: Vec<usize>) -> Collector {
        self.slots.beside = slots;
        self
    }

    /// The blocks, with the sample interval that the whole recording has.
    pub fn finish(mut self, interval_s: f64) -> Blocks {
        self.close();
        self.blocks.interval_s = interval_s;
        self.blocks
    }

    fn close(&mut self) {
        let Some(open) = self.open.take() else { return };
        let mut block = open.block;
        for (sum, count) in block.gyro.iter_mut().zip(&open.counts) {
            *sum = if *count > 0 { *sum / f64::from(*count) } else { f64::NAN };
        }
        let mean = |(sum, count): (f64, u32)| if count > 0 { sum / f64::from(count) } else { f64::NAN };
        (block.table_rate, block.outer_rate, block.temperature) =
            (mean(open.others[0]), mean(open.others[1]), mean(open.others[2]));
        for (sum, count) in block.beside.iter_mut().zip(&open.beside) {
            *sum = mean((*sum, *count));
        }
        self.blocks.list.push(block);
        if self.blocks.list.len() >= MOST_BLOCKS {
            self.halve();
        }
    }

    /// Joins blocks in pairs and doubles their length.
    fn halve(&mut self) {
        let old = std::mem::take(&mut self.blocks.list);
        let mut joined: Vec<Block> = Vec::with_capacity(old.len() / 2 + 1);
        let full = self.per_block;
        for block in old {
            match joined.last_mut() {
                Some(last) if block.continues && last.samples <= full && block.samples <= full => {
                    join(last, &block);
                }
                _ => joined.push(block),
            }
        }
        self.blocks.list = joined;
        self.per_block *= 2;
    }

    /// The angle without its jumps at full turns.
    fn unwrap_angle(&mut self, raw: f64, rate_deg_h: f64, index: u64) -> f64 {
        if !raw.is_finite() {
            return f64::NAN;
        }
        let Some((last, at)) = self.angle else {
            self.angle = Some((raw, index));
            return raw;
        };
        // Beyond a turn and a half the channel counts turns by itself.
        self.cumulative |= raw.abs() > 1.5 * TURN_ARCSEC;
        let elapsed_s = (index - at) as f64 * self.blocks.interval_s;
        let expected = if rate_deg_h.is_finite() { rate_deg_h * elapsed_s } else { 0.0 };
        let step = raw - last;
        let value = if self.cumulative {
            raw
        } else {
            let turns = ((step - expected) / TURN_ARCSEC).round();
            raw - turns * TURN_ARCSEC
        };
        self.angle = Some((value, index));
        value
    }
}

fn join(first: &mut Block, second: &Block) {
    let (a, b) = (f64::from(first.samples), f64::from(second.samples));
    let mean = |x: f64, y: f64| {
        if !y.is_finite() {
            x
        } else if !x.is_finite() {
            y
        } else {
            (a * x + b * y) / (a + b)
        }
    };
    for (x, y) in first.gyro.iter_mut().zip(&second.gyro) {
        *x = mean(*x, *y);
    }
    for (x, y) in first.beside.iter_mut().zip(&second.beside) {
        *x = mean(*x, *y);
    }
    first.table_rate = mean(first.table_rate, second.table_rate);
    first.outer_rate = mean(first.outer_rate, second.outer_rate);
    first.temperature = mean(first.temperature, second.temperature);
    first.angle_last = second.angle_last;
    first.samples += second.samples;
}

impl Sink for Collector {
    fn push(&mut self, sample_block: &SampleBlock<'_>) {
        if !sample_block.continues {
            self.close();
        }
        let mut continues = sample_block.continues;
        let at = |slot: Option<usize>, i: usize| {
            slot.and_then(|s| sample_block.values.get(s)).and_then(|v| v.get(i)).copied().unwrap_or(f64::NAN)
        };
        for i in 0..sample_block.len() {
            let index = sample_block.first_index + i as u64;
            let rate = at(self.slots.rate, i);
            let raw = at(self.slots.angle, i);
            let angle =
                if self.slots.angle.is_some() { self.unwrap_angle(raw, rate, index) } else { f64::NAN };
            let (gyros, beside) = (self.slots.gyros.len(), self.slots.beside.len());
            let open = self.open.get_or_insert_with(|| Open {
                block: Block {
                    first_index: index,
                    first_row: sample_block.first_row + i as u64,
                    samples: 0,
                    continues,
                    gyro: vec![0.0; gyros],
                    table_rate: 0.0,
                    outer_rate: 0.0,
                    temperature: 0.0,
                    beside: vec![0.0; beside],
                    angle_first: angle,
                    angle_last: angle,
                },
                counts: vec![0; gyros],
                others: [(0.0, 0); 3],
                beside: vec![0; beside],
            });
            open.block.samples += 1;
            open.block.angle_last = angle;
            for (k, slot) in self.slots.gyros.iter().enumerate() {
                let value = at(Some(*slot), i);
                if value.is_finite() {
                    open.block.gyro[k] += value;
                    open.counts[k] += 1;
                }
            }
            for (k, slot) in self.slots.beside.iter().enumerate() {
                let value = at(Some(*slot), i);
                if value.is_finite() {
                    open.block.beside[k] += value;
                    open.beside[k] += 1;
                }
            }
            for (k, slot) in
                [self.slots.rate, self.slots.outer, self.slots.temperature].into_iter().enumerate()
            {
                let value = at(slot, i);
                if value.is_finite() {
                    open.others[k].0 += value;
                    open.others[k].1 += 1;
                }
            }
            if open.block.samples >= self.per_block {
                self.close();
            }
            continues = true;
        }
    }
}
