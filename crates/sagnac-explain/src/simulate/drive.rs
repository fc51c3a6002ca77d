//! The columns of a simulated recording: from profiles, or from a recording.

use super::seed::stream;
use crate::claim::{Claim, Profile};
use crate::effect::{Column, Drivers, OtherDriver};
use crate::series::{Series, smooth};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::BTreeMap;

/// The noise of the sensor of each profile.
pub(super) struct Sensors {
    sensors: Vec<(Profile, Xoshiro256PlusPlus)>,
}

impl Sensors {
    pub fn new(profiles: &[Profile], seed: u64) -> Sensors {
        let own = |p: &Profile| {
            let place = Column::KNOWN.iter().position(|c| *c == p.column).unwrap_or(0);
            Xoshiro256PlusPlus::seed_from_u64(stream(seed, 100 + place as u64))
        };
        Sensors { sensors: profiles.iter().map(|p| (p.clone(), own(p))).collect() }
    }

    /// What drives the gyro over a block, and what the columns of the recording show of it.
    pub fn block(&mut self, grid: Drivers) -> (Drivers, BTreeMap<Column, Vec<f64>>) {
        let mut drivers = grid;
        let mut shown = BTreeMap::new();
        for (profile, rng) in &mut self.sensors {
            let turn = |v: f64| if profile.column == Column::TableAngle { v.rem_euclid(360.0) } else { v };
            let felt: Vec<f64> = (0..drivers.samples).map(|i| turn(profile.at(drivers.time_s(i)))).collect();
            let mut noisy = felt.clone();
            if profile.noise > 0.0 {
                for v in &mut noisy {
                    let noise: f64 = StandardNormal.sample(rng);
                    *v = turn(*v + profile.noise * noise);
                }
            }
            shown.insert(profile.column, noisy);
            put(&mut drivers, profile.column, felt);
        }
        drivers.smooth_temperature.clone_from(&drivers.temperature);
        (drivers, shown)
    }
}

fn put(drivers: &mut Drivers, column: Column, values: Vec<f64>) {
    let place = match column {
        Column::Temperature => &mut drivers.temperature,
        Column::TableRate => &mut drivers.table_rate,
        Column::TableAngle => &mut drivers.table_angle,
        Column::OuterRate => &mut drivers.outer_rate,
        Column::Supply => &mut drivers.supply,
        Column::Other(_) => {
            drivers.others.retain(|o| o.column != column);
            return drivers.others.push(OtherDriver { column, smooth: smooth(&values), values });
        }
    };
    *place = Some(values);
}

/// The columns of a recording on its grid, straight lines over the gaps.
pub(super) fn of_recording(series: &Series, claim: &Claim, dt_s: f64) -> Drivers {
    let samples = series.index.last().map_or(0, |last| *last as usize + 1);
    let mut drivers = Drivers {
        dt_s,
        start_s: series.time_s.first().copied().unwrap_or(0.0),
        samples,
        averaged: 1,
        claim: claim.mean,
        lines: claim.lines(),
        ..Drivers::default()
    };
    for (column, values) in &series.columns {
        put(&mut drivers, *column, on_grid(&series.index, values, samples, *column == Column::TableAngle));
    }
    drivers.smooth_temperature = drivers.temperature.as_deref().map(smooth);
    drivers
}

fn on_grid(index: &[u64], values: &[f64], samples: usize, is_angle: bool) -> Vec<f64> {
    let mut out = vec![0.0; samples];
    for (at, v) in index.iter().zip(values) {
        if let Some(place) = out.get_mut(*at as usize) {
            *place = *v;
        }
    }
    for (pair, ends) in index.windows(2).zip(values.windows(2)) {
        let (&[a, b], &[from, to]) = (pair, ends) else { continue };
        let mut step = to - from;
        if is_angle {
            step = (step + 180.0).rem_euclid(360.0) - 180.0;
        }
        for i in a + 1..b {
            let v = from + step * (i - a) as f64 / (b - a) as f64;
            out[i as usize] = if is_angle { v.rem_euclid(360.0) } else { v };
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_bridged_the_short_way_round() {
        assert_eq!(on_grid(&[0, 1, 4], &[0.0, 3.0, 9.0], 6, false), [0.0, 3.0, 5.0, 7.0, 9.0, 0.0]);
        assert_eq!(on_grid(&[0, 2], &[350.0, 20.0], 3, true), [350.0, 5.0, 20.0]);
        assert_eq!(on_grid(&[0, 2], &[20.0, 350.0], 3, true), [20.0, 5.0, 350.0]);
    }
}
