//! Values and steps that no sensor of a role can show: those beyond physical bounds are faults of the recording.

use crate::faults::FaultLog;
use sagnac_core::message::{Arg, Note, note};
use sagnac_core::recording::{Channel, Role, SampleBlock};

/// Physical bounds of a quantity, in the unit of the analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Smallest value that is possible.
    pub low: f64,
    /// Largest value that is possible.
    pub high: f64,
    /// Largest change from one sample to the next, where one is known.
    pub change: Option<MaxChange>,
}

/// Largest change of a quantity from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxChange {
    /// However short the interval between them.
    pub at_once: f64,
    /// What an hour between them adds.
    pub hourly: f64,
}

/// The bounds of a role; `None` where nothing is known of the quantity.
pub fn bound(role: Role) -> Option<Bound> {
    let within = |low: f64, high: f64| Some(Bound { low, high, change: None });
    let no_more = |largest: f64| within(-largest, largest);
    let turning = |fastest_deg_s: f64| {
        let largest = fastest_deg_s * 3600.0;
        let change = MaxChange { at_once: AT_ONCE_DEG_S * 3600.0, hourly: SHARPEST_DEG_S2 * 3600.0 * 3600.0 };
        Some(Bound { low: -largest, high: largest, change: Some(change) })
    };
    match role {
        // The fastest spin gyros read 50 000 deg/s; above, a sample is a broken number or has another unit.
        Role::Rate | Role::AngleIncrement | Role::AccumulatedAngle => turning(FASTEST_GYRO_DEG_S),
        // The fastest rate tables turn at 10 000 deg/s.
        Role::TableRate | Role::OuterRate => turning(FASTEST_TABLE_DEG_S),
        // A table turns on and on: only its rate is bounded.
        Role::TableAngle => Some(Bound {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            // Twice a turn: an angle that starts again while it turns, and readings taken between samples.
            change: Some(MaxChange {
                at_once: 2.0 * TURN_ARCSEC,
                hourly: FASTEST_TABLE_DEG_S * 3600.0 * 3600.0,
            }),
        }),
        // Absolute zero, and what no electronics survives.
        Role::Temperature => within(-273.15, 1000.0),
        // Supplies of gyros are some volts to some tens of volts.
        Role::Supply => no_more(1000.0),
        // 20 T: beyond the largest magnets that hold a unit.
        Role::MagneticField => no_more(20_000.0),
        // Rms of an acceleration: no shaker gives 10 000 g. Small negative numbers are the noise of a sensor about zero.
        Role::Vibration => no_more(10_000.0),
        // Guns fire units at 20 000 g; a gyro is not tested there.
        Role::AccelerationX | Role::AccelerationY | Role::AccelerationZ => no_more(20_000.0),
        // Pressure vessels of laboratories hold some ten megapascals.
        Role::Pressure => no_more(100_000.0),
        // Sensors read a little beyond saturation.
        Role::Humidity => within(-20.0, 120.0),
        // Units of kilograms draw some ten amperes.
        Role::Current => no_more(1000.0),
        Role::Time | Role::Counter | Role::Status | Role::Pps | Role::Auxiliary => None,
    }
}

/// Fastest gyro, deg/s.
const FASTEST_GYRO_DEG_S: f64 = 50_000.0;

/// Fastest table, deg/s.
const FASTEST_TABLE_DEG_S: f64 = 10_000.0;

/// Sharpest angular acceleration that a unit is held at while it is tested, deg/s².
const SHARPEST_DEG_S2: f64 = 100_000.0;

/// Change of a rate that a spike makes at once, from one end of a common range to the other, deg/s.
const AT_ONCE_DEG_S: f64 = 5000.0;

/// One turn, arcsec: angles start again after it.
const TURN_ARCSEC: f64 = 1_296_000.0;

/// One channel.
#[derive(Debug, Clone)]
struct Watched {
    id: String,
    role: Role,
    bound: Bound,
    count: u64,
    latest: Option<f64>,
}

/// Watches all channels of a recording.
#[derive(Debug, Clone)]
pub struct Plausible {
    channels: Vec<Option<Watched>>,
    interval_s: f64,
}

impl Plausible {
    /// Starts with the channels, at a sample interval, s.
    pub fn new(channels: &[Channel], interval_s: f64) -> Plausible {
        let watched = |c: &Channel| {
            let (id, role, bound) = (c.id.clone(), c.role, bound(c.role)?);
            Some(Watched { id, role, bound, count: 0, latest: None })
        };
        Plausible { channels: channels.iter().map(watched).collect(), interval_s }
    }

    /// Looks at a sample block and lists what is impossible.
    pub fn push(&mut self, block: &SampleBlock<'_>, log: &mut FaultLog) {
        let interval_s = self.interval_s;
        for (watched, values) in self.channels.iter_mut().zip(block.values) {
            let Some(w) = watched else { continue };
            if !block.continues {
                w.latest = None;
            }
            let Bound { low, high, change } = w.bound;
            if change.is_none() && values.iter().all(|v| !(*v < low || *v > high)) {
                continue;
            }
            for (i, &value) in values.iter().enumerate().filter(|(_, v)| v.is_finite()) {
                let step = w.latest.map_or(0.0, |l| (value - l).abs());
                let most = change.map(|c| c.at_once + c.hourly * interval_s / 3600.0);
                let out = value < low || value > high;
                // A step that is none starts no change: the way back from it is not counted again.
                if !out {
                    w.latest = Some(value);
                }
                if !out && most.is_none_or(|most| step <= most) {
                    continue;
                }
                w.count += 1;
                let at = block.time_s + i as f64 * interval_s;
                log.push("implausible", Some(&w.id), Some(at), block.first_row + i as u64, 1, || {
                    if out {
                        beyond(w.role, value, low, high)
                    } else {
                        leap(w.role, step, most.unwrap_or(0.0))
                    }
                });
            }
        }
    }

    /// Samples that are impossible.
    pub fn count(&self) -> u64 {
        self.channels.iter().flatten().map(|w| w.count).sum()
    }
}

fn beyond(role: Role, value: f64, low: f64, high: f64) -> Note {
    note!(
        "plausible.value",
        value = Arg::figures(value, 6),
        bound = Arg::figures(if value < low { low } else { high }, 6),
        unit = unit_of(role)
    )
}

/// Unit of the values that are watched: outputs are rates by then, whatever was recorded.
fn unit_of(role: Role) -> &'static str {
    if role.is_gyro() { "deg/h" } else { role.internal_unit().unwrap_or("") }
}

fn leap(role: Role, step: f64, most: f64) -> Note {
    if role != Role::TableAngle {
        return note!(
            "plausible.leap",
            step_deg_s = Arg::figures(step / 3600.0, 6),
            most_deg_s = Arg::figures(most / 3600.0, 6)
        );
    }
    note!(
        "plausible.angle",
        step_deg = Arg::figures(step / 3600.0, 6),
        most_deg = Arg::figures(most / 3600.0, 6),
        rate_deg_s = FASTEST_TABLE_DEG_S
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use sagnac_core::recording::ColumnRef;
    use sagnac_core::units::Unit;

    fn watched(role: Role, values: Vec<f64>) -> u64 {
        let channel = Channel {
            id: "x".to_owned(),
            column: ColumnRef::Position(1),
            role,
            unit: Unit::parse(role.internal_unit().unwrap()).unwrap(),
            scale: 1.0,
        };
        let mut plausible = Plausible::new(&[channel], 0.01);
        let values = [values];
        let block =
            SampleBlock { first_index: 0, first_row: 1, time_s: 0.0, continues: false, values: &values };
        plausible.push(&block, &mut FaultLog::default());
        plausible.count()
    }

    #[test]
    fn an_angle_may_accumulate_but_not_leap() {
        let turning = (0..100_000).map(|i| f64::from(i) * 36_000.0).collect();
        assert_eq!(watched(Role::TableAngle, turning), 0);
        let again = (0..10_000).map(|i| (f64::from(i) * 36_000.0) % TURN_ARCSEC).collect();
        assert_eq!(watched(Role::TableAngle, again), 0);
        assert_eq!(watched(Role::TableAngle, vec![0.0, 1e7, 0.0]), 2);
    }

    #[test]
    fn values_that_no_sensor_shows_are_counted() {
        assert_eq!(watched(Role::Rate, vec![1.7e8, 1.9e8, -1e30, f64::NAN]), 2);
        assert_eq!(watched(Role::TableRate, vec![3.5e7, 3.7e7]), 1);
        // From one end of a range to the other: a spike of a unit of 2000 deg/s, and numbers that are none.
        assert_eq!(watched(Role::Rate, vec![0.0, 7.2e6, -7.2e6, 0.0]), 0);
        assert_eq!(watched(Role::Rate, vec![0.0, 9e7, -9e7, 0.0]), 3);
        assert_eq!(watched(Role::Temperature, vec![-274.0, -55.0, 125.0]), 1);
        assert_eq!(watched(Role::Supply, vec![5.0, 28.0, 1e9]), 1);
    }
}
