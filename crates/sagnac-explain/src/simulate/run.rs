//! A simulation, block by block.

use super::SimulateError;
use super::drive::{Sensors, of_recording};
use super::noise::{Noise, composed, low_pass};
use super::quantize::Counter;
use super::seed::stream;
use crate::claim::{Claim, Profile, Stated};
use crate::effect::{Column, Drivers, Model, Samples};
use crate::message::{Arg, note};
use crate::series::Series;
use std::collections::BTreeMap;

/// Samples of a block where the claim states nothing that has to be made as a whole.
const BLOCK: usize = 1 << 16;

/// Most samples of a recording that has to be made as a whole.
const MAX_SAMPLES_IN_MEMORY: u64 = 200_000_000;

/// Most samples of a recording.
const MAX_SAMPLES: u64 = 10_000_000_000;

/// Most by which the sample rate of a recording may differ from that of the claim, relative.
const RATE_TOLERANCE: f64 = 0.01;

/// What a simulation goes over.
#[derive(Clone, Copy)]
pub enum Over<'a> {
    /// So many seconds, with columns from profiles.
    Duration {
        /// Length, s.
        duration_s: f64,
        /// `time_s` of the first sample, s.
        start_s: f64,
        /// Courses of the columns.
        drivers: &'a [Profile],
    },
    /// The rows and columns of a recording.
    Like(&'a Series),
}

/// The order of a simulation.
#[derive(Clone, Copy)]
pub struct Order<'a> {
    /// The claim.
    pub claim: &'a Claim,
    /// Seed: equal seeds give equal recordings.
    pub seed: u64,
    /// Over what.
    pub over: Over<'a>,
}

/// Some rows of a simulated recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// s.
    pub time_s: Vec<f64>,
    /// deg/h.
    pub rate_deg_h: Vec<f64>,
    /// Columns beside, in the units that their names tell.
    pub columns: BTreeMap<Column, Vec<f64>>,
}

/// A running simulation.
pub struct Simulation<'a> {
    order: Order<'a>,
    dt_s: f64,
    samples: u64,
    noise: Noise,
    sensors: Sensors,
    counter: Option<Counter>,
    done: u64,
    block: usize,
}

impl<'a> Simulation<'a> {
    /// Begins a simulation.
    ///
    /// # Errors
    /// A claim whose effects lack parameters or columns, a length that cannot be made, a recording of another rate.
    pub fn begin(order: Order<'a>) -> Result<Simulation<'a>, SimulateError> {
        let claim = order.claim;
        let claimed_s = 1.0 / claim.sample_rate_hz;
        let (dt_s, samples) = match order.over {
            Over::Duration { duration_s, .. } => (claimed_s, (duration_s * claim.sample_rate_hz).round()),
            Over::Like(series) => {
                let own = series.sample_interval_s;
                let off = (own * claim.sample_rate_hz - 1.0).abs();
                if series.time_s.is_empty() {
                    return Err(note!("simulate.no_rows").into());
                }
                if off.is_nan() || off > RATE_TOLERANCE {
                    let note = note!(
                        "simulate.other_rate",
                        found = Arg::rounded(1.0 / own, 6),
                        claimed = Arg::rounded(claim.sample_rate_hz, 6)
                    );
                    return Err(note.into());
                }
                (own, series.index.last().map_or(0, |last| last + 1) as f64)
            }
        };
        let whole = matches!(order.over, Over::Like(_))
            || claim.effects.iter().any(|e| !matches!(e.effect.model(), Model::Spectrum(_)));
        let most = if whole { MAX_SAMPLES_IN_MEMORY } else { MAX_SAMPLES };
        if !(1.0..=most as f64).contains(&samples) {
            let note = note!("simulate.length", samples = samples.to_string(), most);
            return Err(note.into());
        }
        let samples = samples as u64;
        needs(&order)?;
        let noise = composed(claim)?;
        // An effect of that kind states the whole of the quantisation.
        let restated = noise.terms.q != claim.noise.q;
        let step = if restated { noise.terms.q * 12f64.sqrt() } else { claim.quantization_lsb_arcsec };
        let profiles = match order.over {
            Over::Duration { drivers, .. } => drivers,
            Over::Like(_) => &[],
        };
        Ok(Simulation {
            noise: Noise::new(&noise, low_pass(claim), order.seed, dt_s, samples),
            sensors: Sensors::new(profiles, order.seed),
            counter: Counter::new(step, dt_s),
            done: 0,
            block: if whole { usize::MAX } else { BLOCK },
            order,
            dt_s,
            samples,
        })
    }

    /// Sets the samples that are made at once; the output does not depend on it.
    pub fn set_block(&mut self, samples: usize) {
        self.block = samples;
    }

    /// Samples of the grid; rows may be fewer.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Length of the grid, s.
    pub fn length_s(&self) -> f64 {
        self.samples as f64 * self.dt_s
    }

    /// Samples of the grid that were made.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// Columns beside time and rate.
    pub fn columns(&self) -> Vec<Column> {
        columns(&self.order.over)
    }

    /// The next rows; `None` at the end.
    ///
    /// # Errors
    /// An effect whose parameters do not suffice for its forward model.
    pub fn next_rows(&mut self) -> Result<Option<Rows>, SimulateError> {
        let left = self.samples - self.done;
        if left == 0 {
            return Ok(None);
        }
        let samples = usize::try_from(left).unwrap_or(usize::MAX).min(self.block);
        let claim = self.order.claim;
        let (drivers, shown) = match self.order.over {
            Over::Duration { start_s, .. } => self.sensors.block(Drivers {
                dt_s: self.dt_s,
                start_s: start_s + self.done as f64 / claim.sample_rate_hz,
                samples,
                averaged: 1,
                claim: claim.mean,
                lines: claim.lines(),
                ..Drivers::default()
            }),
            Over::Like(series) => (of_recording(series, claim, self.dt_s), BTreeMap::new()),
        };
        let mut rate = self.noise.take(samples);
        let mut keep = vec![true; samples];
        for (y, m) in rate.iter_mut().zip(drivers.claimed_mean()) {
            *y += claim.mean.bias_deg_h + m;
        }
        on_samples(claim, self.order.seed, &drivers, &mut rate, &mut keep);
        for stated in &claim.effects {
            for (y, c) in rate.iter_mut().zip(course(stated, &drivers)?.into_iter().flatten()) {
                *y += c;
            }
        }
        if let Some(counter) = &mut self.counter {
            counter.count(&mut rate);
        }
        let rows = match self.order.over {
            Over::Duration { start_s, .. } => {
                let first = self.done;
                let time = (0..samples as u64).map(|i| start_s + (first + i) as f64 / claim.sample_rate_hz);
                Rows { time_s: time.collect(), rate_deg_h: rate, columns: shown }.kept(&keep)
            }
            Over::Like(series) => like(series, &rate, &keep),
        };
        self.done += samples as u64;
        Ok(Some(rows))
    }

    /// The whole recording.
    ///
    /// # Errors
    /// As [`Simulation::next_rows`].
    pub fn all(mut self) -> Result<Rows, SimulateError> {
        let mut all = Rows::default();
        while let Some(rows) = self.next_rows()? {
            all.time_s.extend(rows.time_s);
            all.rate_deg_h.extend(rows.rate_deg_h);
            for (column, values) in rows.columns {
                all.columns.entry(column).or_default().extend(values);
            }
        }
        Ok(all)
    }
}

fn columns(over: &Over<'_>) -> Vec<Column> {
    match over {
        Over::Duration { drivers, .. } => {
            Column::KNOWN.into_iter().filter(|c| drivers.iter().any(|p| p.column == *c)).collect()
        }
        Over::Like(series) => series.columns.keys().copied().collect(),
    }
}

/// Refuses an effect whose columns are not there.
fn needs(order: &Order<'_>) -> Result<(), SimulateError> {
    let there = columns(&order.over);
    for stated in &order.claim.effects {
        let missing: Vec<&str> =
            stated.effect.needs().iter().filter(|c| !there.contains(c)).map(|c| c.name()).collect();
        if !missing.is_empty() {
            let note = note!("simulate.no_column", kind = stated.effect.kind());
            return Err(note.with("columns", missing.join(", ")).into());
        }
    }
    Ok(())
}

/// The course that a stated effect adds; `None` for one that has none.
fn course(stated: &Stated, drivers: &Drivers) -> Result<Option<Vec<f64>>, SimulateError> {
    let model = match stated.effect.model() {
        Model::Mean(model) => model,
        Model::Spectrum(_) => return Ok(stated.effect.claimed_course(&stated.values, drivers)),
        Model::Samples(_) => return Ok(None),
    };
    match model.course(&stated.values, drivers) {
        Some(course) => Ok(Some(course)),
        None => Err(note!("simulate.no_parameters", kind = stated.effect.kind()).into()),
    }
}

/// Effects on single samples act on the claimed mean with its noise, before other effects add to the mean: what scales
/// the noise scales what departs from the claim. What scales comes before what adds.
fn on_samples(claim: &Claim, seed: u64, drivers: &Drivers, rate: &mut [f64], keep: &mut [bool]) {
    let mut acting: Vec<(usize, &Stated, &dyn Samples)> = vec![];
    for (place, stated) in claim.effects.iter().enumerate() {
        if let Model::Samples(samples) = stated.effect.model() {
            acting.push((place, stated, samples));
        }
    }
    acting.sort_by_key(|(_, stated, _)| !stated.effect.sets_level());
    for (place, stated, samples) in acting {
        samples.apply(&stated.values, drivers, stream(seed, 1000 + place as u64), rate, keep);
    }
}

/// The rows of a recording with another rate.
fn like(series: &Series, rate: &[f64], keep: &[bool]) -> Rows {
    let there = |i: &usize| keep.get(series.index[*i] as usize).copied().unwrap_or(false);
    let rows: Vec<usize> = (0..series.time_s.len()).filter(there).collect();
    let of = |values: &[f64]| rows.iter().filter_map(|i| values.get(*i).copied()).collect::<Vec<f64>>();
    Rows {
        time_s: of(&series.time_s),
        rate_deg_h: rows.iter().filter_map(|i| rate.get(series.index[*i] as usize).copied()).collect(),
        columns: series.columns.iter().map(|(column, values)| (*column, of(values))).collect(),
    }
}

impl Rows {
    /// The rows that are kept.
    fn kept(mut self, keep: &[bool]) -> Rows {
        if keep.iter().all(|k| *k) {
            return self;
        }
        let pick = |values: &mut Vec<f64>| {
            let mut at = keep.iter();
            values.retain(|_| at.next().copied().unwrap_or(true));
        };
        pick(&mut self.time_s);
        pick(&mut self.rate_deg_h);
        self.columns.values_mut().for_each(pick);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_lost_are_lost_in_every_column() {
        let rows = Rows {
            time_s: vec![0.0, 1.0, 2.0],
            rate_deg_h: vec![5.0, 6.0, 7.0],
            columns: BTreeMap::from([(Column::Supply, vec![27.0, 28.0, 29.0])]),
        };
        let kept = rows.clone().kept(&[true, false, true]);
        assert_eq!((kept.time_s, kept.rate_deg_h), (vec![0.0, 2.0], vec![5.0, 7.0]));
        assert_eq!(kept.columns[&Column::Supply], [27.0, 29.0]);
        assert_eq!(rows.clone().kept(&[true; 3]), rows);
    }

    #[test]
    fn another_rate_keeps_the_rows_of_the_recording() {
        let series = Series {
            time_s: vec![10.0, 11.0, 13.0],
            rate_deg_h: vec![0.0; 3],
            index: vec![0, 1, 3],
            sample_interval_s: 1.0,
            ..Series::default()
        };
        let rows = like(&series, &[1.0, 2.0, 3.0, 4.0], &[true, false, true, true]);
        assert_eq!((rows.time_s, rows.rate_deg_h), (vec![10.0, 13.0], vec![1.0, 4.0]));
    }
}
