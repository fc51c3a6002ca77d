//! Start-ups at several temperatures: every switching-on of a recording belongs to the zone that its temperature lies in.
//!
//! Of several switchings-on in one zone, the largest value of each quantity counts: a limit holds for every one.

use super::{Drawn, InZone, Moment, StartUp, StartUpCollector, StartUpTest, Zone};
use crate::recording::{Channel, Role, SampleBlock, Sink};

/// One switching-on with the temperatures of its samples while on.
struct One {
    collector: StartUpCollector,
    sum_deg_c: f64,
    count: u64,
}

impl One {
    fn temperature_deg_c(&self) -> f64 {
        self.sum_deg_c / self.count as f64
    }
}

/// Collects every switching-on of a recording, or the first where no zones are asked for.
pub struct SwitchingsOn {
    test: StartUpTest,
    channels: Vec<Channel>,
    interval_s: f64,
    supply: Option<usize>,
    temperature: Option<usize>,
    before: Vec<One>,
    now: One,
}

impl SwitchingsOn {
    /// For the channels of a recording; the first temperature is that of the unit.
    pub fn new(test: StartUpTest, channels: &[Channel], interval_s: f64) -> SwitchingsOn {
        let slot = |role: Role| channels.iter().position(|c| c.role == role);
        let collector = StartUpCollector::new(test.clone(), channels, interval_s);
        SwitchingsOn {
            supply: slot(Role::Supply),
            temperature: slot(Role::Temperature),
            before: vec![],
            now: One { collector, sum_deg_c: 0.0, count: 0 },
            channels: channels.to_vec(),
            test,
            interval_s,
        }
    }

    fn sample(&mut self, time_s: f64, value: impl Fn(usize) -> Option<f64>) {
        let volts = self.supply.and_then(&value).filter(|v| v.is_finite());
        let was_on = self.now.collector.on_s.is_some();
        if was_on && volts.is_some_and(|v| v < self.test.on_voltage_v) {
            let collector = StartUpCollector::new(self.test.clone(), &self.channels, self.interval_s);
            let next = One { collector, sum_deg_c: 0.0, count: 0 };
            self.before.push(std::mem::replace(&mut self.now, next));
        }
        self.now.collector.sample(time_s, &value);
        let warm = self.temperature.and_then(&value).filter(|t| t.is_finite());
        if let (true, Some(deg_c)) = (self.now.collector.on_s.is_some(), warm) {
            self.now.sum_deg_c += deg_c;
            self.now.count += 1;
        }
    }

    /// What was found: a start-up for every gyro channel, and where zones are asked for, for each of them. `interval_s` is the
    /// measured interval.
    pub fn finish(self, interval_s: f64) -> Vec<StartUp> {
        if self.test.zones.is_empty() {
            return self.now.collector.finish(interval_s);
        }
        let starts: Vec<(f64, Vec<StartUp>)> = self
            .before
            .into_iter()
            .chain([self.now])
            .filter(|one| one.collector.on_s.is_some())
            .map(|one| (one.temperature_deg_c(), one.collector.finish(interval_s)))
            .collect();
        let gyros: Vec<&Channel> = self.channels.iter().filter(|c| c.role.is_gyro()).collect();
        let of_zone = |(at, gyro): (usize, &&Channel), zone: &Zone| {
            let inside = |t: &f64| (t - zone.at_deg_c).abs() <= zone.half_width_deg_c * (1.0 + f64::EPSILON);
            let own: Vec<(f64, &StartUp)> = starts
                .iter()
                .filter(|(t, _)| inside(t))
                .filter_map(|(t, all)| Some((*t, all.get(at)?)))
                .collect();
            let name = format!("{}@{}", gyro.id, zone.at_deg_c);
            largest(name, interval_s, &own)
        };
        let zones = &self.test.zones;
        gyros.iter().enumerate().flat_map(|gyro| zones.iter().map(move |zone| of_zone(gyro, zone))).collect()
    }
}

/// The largest of every quantity over switchings-on with their temperatures.
fn largest(channel: String, interval_s: f64, starts: &[(f64, &StartUp)]) -> StartUp {
    let moment = |of: fn(&StartUp) -> Moment| {
        starts.iter().map(|(_, s)| of(s)).reduce(later).unwrap_or(Moment::NoStart)
    };
    let drawn = |of: fn(&StartUp) -> Option<Drawn>| {
        starts.iter().filter_map(|(_, s)| of(s)).reduce(|a, b| {
            let more = if a.value >= b.value { a } else { b };
            Drawn { at_least: a.at_least || b.at_least, ..more }
        })
    };
    let count = starts.len();
    StartUp {
        channel,
        interval_s,
        zone: Some(InZone {
            starts: count,
            temperature_deg_c: starts.iter().map(|(t, _)| t).sum::<f64>() / count as f64,
        }),
        first_sample: moment(|s| s.first_sample),
        valid_data: moment(|s| s.valid_data),
        power_steady: drawn(|s| s.power_steady),
        power_peak: drawn(|s| s.power_peak),
        inrush_current: drawn(|s| s.inrush_current),
    }
}

/// The later of two moments; one that did not come is the latest.
fn later(a: Moment, b: Moment) -> Moment {
    let rank = |m: &Moment| match m {
        Moment::Unstated => (3, 0.0),
        Moment::Never | Moment::NoStart => (2, 0.0),
        Moment::AtLeast(time_s) | Moment::At { time_s, .. } => (1, *time_s),
    };
    let (of_a, of_b) = (rank(&a), rank(&b));
    if of_a.0 > of_b.0 || of_a.0 == of_b.0 && of_a.1 >= of_b.1 { a } else { b }
}

impl Sink for SwitchingsOn {
    fn push(&mut self, block: &SampleBlock<'_>) {
        if self.test.zones.is_empty() {
            return self.now.collector.push(block);
        }
        for i in 0..block.len() {
            let time_s = block.time_s + i as f64 * self.interval_s;
            self.sample(time_s, |slot| block.values.get(slot).and_then(|v| v.get(i)).copied());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Valid;
    use super::*;
    use crate::recording::ColumnRef;
    use crate::units::Unit;

    fn found(zones: Vec<Zone>) -> Vec<StartUp> {
        let of = |(at, (id, role)): (usize, (&str, Role))| Channel {
            id: id.into(),
            column: ColumnRef::Position(at + 1),
            role,
            unit: Unit::pure(),
            scale: 1.0,
        };
        let roles = [("x", Role::Rate), ("v", Role::Supply), ("i", Role::Current), ("t", Role::Temperature)];
        let channels: Vec<Channel> = roles.into_iter().enumerate().map(of).collect();
        let test = StartUpTest {
            on_voltage_v: 3.0,
            steady_after_s: 5.0,
            inrush_within_s: 1.0,
            valid: Valid::Unstated,
            voltage_uncertainty: 0.001,
            current_uncertainty: 0.002,
            zones,
        };
        let mut starts = SwitchingsOn::new(test, &channels, 0.1);
        let mut values = vec![vec![]; 4];
        // Off for 2 s, then on for 18 s: at −40 °C twice, at 60 °C once. The first sample comes after 0.5, 0.8 and 0.3 s.
        for (deg_c, amperes, first_s) in [(-40.0, 0.8, 0.5), (-40.5, 0.9, 0.8), (60.0, 0.4, 0.3)] {
            for i in 0..200 {
                let since = f64::from(i) * 0.1 - 2.0;
                let is_on = since > -1e-9;
                values[0].push(if since > first_s - 1e-9 { 1.0 } else { f64::NAN });
                values[1].push(if is_on { 5.0 } else { 0.0 });
                values[2].push(if is_on { amperes } else { 0.0 });
                values[3].push(deg_c);
            }
        }
        let block =
            SampleBlock { first_index: 0, first_row: 1, time_s: 0.0, continues: false, values: &values };
        starts.push(&block);
        starts.finish(0.1)
    }

    #[test]
    fn every_zone_has_the_largest_of_its_switchings_on() {
        let zone = |at_deg_c| Zone { at_deg_c, half_width_deg_c: 3.0 };
        let found = found(vec![zone(-40.0), zone(20.0), zone(60.0)]);
        let names: Vec<&str> = found.iter().map(|s| s.channel.as_str()).collect();
        assert_eq!(names, ["x@-40", "x@20", "x@60"]);
        let starts: Vec<usize> = found.iter().filter_map(|s| s.zone).map(|z| z.starts).collect();
        assert_eq!(starts, [2, 0, 1]);
        let watts = |s: &StartUp| s.power_steady.map(|p| (p.value * 1e9).round() / 1e9);
        assert_eq!(found.iter().map(watts).collect::<Vec<_>>(), [Some(4.5), None, Some(2.0)]);
        assert!(matches!(found[0].first_sample, Moment::At { time_s, .. } if (time_s - 0.8).abs() < 1e-9));
        assert!(matches!(found[2].first_sample, Moment::At { time_s, .. } if (time_s - 0.3).abs() < 1e-9));
        assert_eq!(found[1].first_sample, Moment::NoStart);
        let warm = found[0].zone.map(|z| z.temperature_deg_c);
        assert!(warm.is_some_and(|t| (t + 40.25).abs() < 1e-9), "{warm:?}");
    }

    #[test]
    fn without_zones_the_first_switching_on_counts() {
        let found = found(vec![]);
        assert_eq!((found.len(), found[0].channel.as_str(), found[0].zone), (1, "x", None));
        assert!(matches!(found[0].first_sample, Moment::At { time_s, .. } if (time_s - 0.5).abs() < 1e-9));
    }
}
