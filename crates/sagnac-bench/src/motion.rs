//! A schedule as it is carried out: leg after leg, each begun when what it needs is reached.

use crate::clock::{SECOND_NS, ns, seconds};
use crate::setup::Bench;
use sagnac_base::message::{Arg, Note, note};
use std::collections::BTreeMap;
use std::time::Duration;

/// Rate of a table, deg/s, as schedules name it.
pub const TABLE_RATE: &str = "table_rate_deg_s";
/// Angle of a table, deg.
pub const TABLE_ANGLE: &str = "table_angle_deg";
/// Pause between two set points of a ramp.
const SET_POINT_NS: i64 = 5 * SECOND_NS;

/// A part of a schedule in which nothing changes its pace.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Leg {
    /// Length.
    pub length: Duration,
    /// What each quantity is at its beginning.
    pub from: BTreeMap<String, f64>,
    /// What it is at its end.
    pub to: BTreeMap<String, f64>,
}

impl Leg {
    /// A leg in which everything stays where it is.
    pub fn at_rest(length: Duration, at: BTreeMap<String, f64>) -> Leg {
        Leg { length, to: at.clone(), from: at }
    }

    /// Change of a quantity in a second.
    fn pace(&self, quantity: &str) -> f64 {
        let ends = self.from.get(quantity).zip(self.to.get(quantity));
        let length_s = self.length.as_secs_f64();
        ends.map_or(0.0, |(from, to)| if length_s > 0.0 { (to - from) / length_s } else { 0.0 })
    }

    /// Quantities that it holds, in the order in which they are set: a table that turns has no angle, and stops before it goes to
    /// one.
    fn quantities(&self) -> Vec<&str> {
        let turns = self.from.get(TABLE_RATE).is_some_and(|rate| *rate != 0.0);
        let (angle, mut all): (Vec<&str>, Vec<&str>) =
            self.from.keys().map(String::as_str).partition(|quantity| *quantity == TABLE_ANGLE);
        if !turns {
            all.extend(angle);
        }
        all
    }
}

/// What of a schedule the bench cannot carry out, or is not allowed to; empty where it can.
pub fn problems(legs: &[Leg], bench: &Bench) -> Vec<Note> {
    let demands = bench.demands();
    let mut found: Vec<Note> = vec![];
    let mut add = |note: Note| {
        if !found.contains(&note) {
            found.push(note);
        }
    };
    for leg in legs {
        for (quantity, value) in leg.from.iter().chain(&leg.to) {
            let Some((device, demand)) = demands.get(quantity.as_str()) else {
                add(note!("bench_plan.nobody", quantity = quantity.as_str()));
                continue;
            };
            let [low, high] = demand.limits;
            if !demand.allows(*value) {
                add(note!(
                    "bench_plan.beyond_limit",
                    device = device.id.as_str(),
                    quantity = quantity.as_str(),
                    value = Arg::Stated(*value),
                    low = Arg::Stated(low),
                    high = Arg::Stated(high)
                ));
            }
            let pace_per_h = leg.pace(quantity).abs() * 3600.0;
            if let Some(fastest) = demand.fastest_per_h.filter(|fastest| pace_per_h > fastest * (1.0 + 1e-9))
            {
                add(note!(
                    "bench_plan.too_fast",
                    device = device.id.as_str(),
                    quantity = quantity.as_str(),
                    pace = Arg::rounded(pace_per_h, 4),
                    fastest = Arg::Stated(fastest)
                ));
            }
        }
    }
    found
}

/// What is asked for now.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Asked {
    /// The quantity.
    pub quantity: String,
    /// Its value.
    pub value: f64,
    /// Pace of the quantity, in its unit a second: what moves may lag behind.
    pub pace_per_s: f64,
}

/// Where a schedule stands.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// The leg is to begin.
    Entering,
    /// What it needs is waited for.
    Approaching,
    /// It runs since a time, with the next set point at another.
    Running { since_ns: i64, set_point_ns: i64 },
}

/// A schedule at work.
#[derive(Debug)]
pub(crate) struct Motion {
    legs: Vec<Leg>,
    at: usize,
    phase: Phase,
    /// What was asked for last.
    set: BTreeMap<String, f64>,
}

impl Motion {
    /// A schedule that is to be carried out.
    pub fn new(legs: Vec<Leg>) -> Motion {
        Motion { legs, at: 0, phase: Phase::Entering, set: BTreeMap::new() }
    }

    /// True at its end.
    pub fn is_done(&self) -> bool {
        self.at >= self.legs.len()
    }

    /// When it goes on by the clock alone; `None` where it waits for something.
    pub fn next_ns(&self) -> Option<i64> {
        let Phase::Running { since_ns, set_point_ns } = self.phase else { return None };
        let leg = self.legs.get(self.at)?;
        let end = since_ns.saturating_add(ns(leg.length));
        Some(if leg.from == leg.to { end } else { end.min(set_point_ns) })
    }

    /// Goes on to a time. `reached` tells whether a quantity is where it was asked to be; `began` is told of each leg that runs.
    pub fn go_on(
        &mut self,
        now_ns: i64,
        reached: impl Fn(&str) -> bool,
        mut began: impl FnMut(usize, f64),
    ) -> Vec<Asked> {
        let mut asked = vec![];
        while let Some(leg) = self.legs.get(self.at) {
            let quantities = leg.quantities();
            match self.phase {
                Phase::Entering => {
                    // A table that turned is at no angle that was asked for.
                    self.set.retain(|quantity, _| quantities.contains(&quantity.as_str()));
                    for quantity in &quantities {
                        let Some(value) = leg.from.get(*quantity) else { continue };
                        put(&mut self.set, &mut asked, quantity, *value, leg.pace(quantity));
                    }
                    self.phase = Phase::Approaching;
                    // What was asked for just now is not reached yet.
                    if !asked.is_empty() {
                        break;
                    }
                }
                Phase::Approaching => {
                    if !quantities.iter().all(|quantity| reached(quantity)) {
                        break;
                    }
                    began(self.at + 1, leg.length.as_secs_f64());
                    self.phase = Phase::Running { since_ns: now_ns, set_point_ns: now_ns + SET_POINT_NS };
                }
                Phase::Running { since_ns, set_point_ns } => {
                    let length_ns = ns(leg.length);
                    let is_over = now_ns - since_ns >= length_ns;
                    if !is_over && (leg.from == leg.to || now_ns < set_point_ns) {
                        break;
                    }
                    for quantity in &quantities {
                        let Some((from, to)) = leg.from.get(*quantity).zip(leg.to.get(*quantity)) else {
                            continue;
                        };
                        if from == to {
                            continue;
                        }
                        let pace = leg.pace(quantity);
                        let value = if is_over { *to } else { from + pace * seconds(now_ns - since_ns) };
                        put(&mut self.set, &mut asked, quantity, value, if is_over { 0.0 } else { pace });
                    }
                    if !is_over {
                        self.phase = Phase::Running { since_ns, set_point_ns: now_ns + SET_POINT_NS };
                        break;
                    }
                    self.at += 1;
                    self.phase = Phase::Entering;
                }
            }
        }
        asked
    }
}

/// Asks for a value that was not asked for last.
fn put(set: &mut BTreeMap<String, f64>, asked: &mut Vec<Asked>, quantity: &str, value: f64, pace_per_s: f64) {
    if set.get(quantity) != Some(&value) {
        set.insert(quantity.to_owned(), value);
        asked.push(Asked { quantity: quantity.to_owned(), value, pace_per_s });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Demand, Device, Language, Link};

    fn at(pairs: &[(&str, f64)]) -> BTreeMap<String, f64> {
        pairs.iter().map(|(quantity, value)| ((*quantity).to_owned(), *value)).collect()
    }

    fn values(asked: Vec<Asked>) -> Vec<(String, f64)> {
        asked.into_iter().map(|a| (a.quantity, a.value)).collect()
    }

    fn named(pairs: &[(&str, f64)]) -> Vec<(String, f64)> {
        pairs.iter().map(|(quantity, value)| ((*quantity).to_owned(), *value)).collect()
    }

    #[test]
    fn a_leg_begins_when_what_it_needs_is_reached_and_lasts_its_length() {
        let rest = |length_s, rate| Leg::at_rest(Duration::from_secs(length_s), at(&[(TABLE_RATE, rate)]));
        let mut motion = Motion::new(vec![rest(10, 5.0), rest(20, -5.0)]);
        let mut legs = vec![];
        let mut step = |motion: &mut Motion, now_s: i64, is_reached: bool| {
            values(motion.go_on(now_s * SECOND_NS, |_| is_reached, |number, _| legs.push((number, now_s))))
        };
        assert_eq!(step(&mut motion, 0, false), named(&[(TABLE_RATE, 5.0)]));
        assert_eq!(step(&mut motion, 3, false), []);
        assert_eq!(motion.next_ns(), None);
        assert_eq!(step(&mut motion, 4, true), []);
        assert_eq!(motion.next_ns(), Some(14 * SECOND_NS));
        assert_eq!(step(&mut motion, 13, true), []);
        assert_eq!(step(&mut motion, 14, true), named(&[(TABLE_RATE, -5.0)]));
        assert_eq!(step(&mut motion, 15, true), []);
        assert!(!motion.is_done());
        assert_eq!(step(&mut motion, 35, true), []);
        assert!(motion.is_done());
        assert_eq!(legs, [(1, 4), (2, 15)]);
    }

    #[test]
    fn a_ramp_has_set_points_and_ends_at_its_end() {
        let temp = |value| at(&[("temp_degC", value)]);
        let ramp = Leg { length: Duration::from_secs(12), from: temp(20.0), to: temp(32.0) };
        let mut motion = Motion::new(vec![ramp, Leg::at_rest(Duration::from_secs(5), temp(32.0))]);
        let mut found = vec![];
        for now_s in 0..20 {
            let asked = motion.go_on(now_s * SECOND_NS, |_| true, |_, _| {});
            found.extend(asked.into_iter().map(|a| (now_s, a.value, a.pace_per_s)));
        }
        assert_eq!(found, [(0, 20.0, 1.0), (6, 25.0, 1.0), (11, 30.0, 1.0), (13, 32.0, 0.0)]);
        assert!(motion.is_done());
    }

    #[test]
    fn a_table_stops_before_it_goes_to_an_angle_and_goes_there_anew_after_a_turn() {
        let state = |rate| at(&[(TABLE_ANGLE, 90.0), (TABLE_RATE, rate)]);
        let leg = |rate| Leg::at_rest(Duration::from_secs(1), state(rate));
        let mut motion = Motion::new(vec![leg(0.0), leg(10.0), leg(0.0)]);
        let found: Vec<_> =
            (0..8).flat_map(|now_s| values(motion.go_on(now_s * SECOND_NS, |_| true, |_, _| {}))).collect();
        let still = [(TABLE_RATE, 0.0), (TABLE_ANGLE, 90.0)];
        assert_eq!(found, named(&[&still[..], &[(TABLE_RATE, 10.0)], &still[..]].concat()));
    }

    #[test]
    fn a_schedule_is_checked_against_the_limits_before_anything_moves() {
        let demand = Demand {
            quantity: "temp_degC".to_owned(),
            send: String::new(),
            reads: "temp_degC".to_owned(),
            limits: [-10.0, 60.0],
            tolerance: 0.5,
            within: Duration::from_secs(60),
            fastest_per_h: Some(30.0),
            begin: None,
            is_angle: false,
        };
        let chamber = Device {
            id: "chamber".to_owned(),
            is_unit: false,
            link: Link::Tcp(String::new()),
            language: Language::Json,
            heartbeat: Duration::from_secs(1),
            patience: Duration::from_secs(1),
            clock_step: Duration::from_secs(1),
            demands: vec![demand],
            has_safe_state: true,
        };
        let bench = Bench { part: Duration::from_secs(60), devices: vec![chamber] };
        let ids = |legs: &[Leg]| problems(legs, &bench).iter().map(|n| n.id.to_string()).collect::<Vec<_>>();
        let ramp = |to, hours: f64| Leg {
            length: Duration::from_secs_f64(hours * 3600.0),
            from: at(&[("temp_degC", 0.0)]),
            to: at(&[("temp_degC", to)]),
        };
        assert_eq!(ids(&[ramp(60.0, 2.0)]), Vec::<String>::new());
        assert_eq!(ids(&[ramp(61.0, 3.0)]), ["bench_plan.beyond_limit"]);
        assert_eq!(ids(&[ramp(60.0, 1.9)]), ["bench_plan.too_fast"]);
        assert_eq!(ids(&[Leg::at_rest(Duration::ZERO, at(&[(TABLE_RATE, 1.0)]))]), ["bench_plan.nobody"]);
    }
}
