//! A schedule of a test: what chamber and table do, step after step, and the columns that a recording of it has.

use crate::claim::Profile;
use crate::effect::Column;
use serde::{Deserialize, Serialize};

/// Seconds of an hour.
const HOUR_S: f64 = 3600.0;

/// Where chamber and table begin. What is left out does not exist: a column without a start is not recorded, unless a
/// step moves it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Start {
    /// Temperature of the chamber, °C.
    #[serde(rename = "temp_degC", default, skip_serializing_if = "Option::is_none")]
    pub temp_degc: Option<f64>,
    /// Rate of the table, deg/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_rate_deg_s: Option<f64>,
    /// Angle of the table, deg.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_angle_deg: Option<f64>,
}

/// One step. What it does not move stays where it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Step {
    /// Everything stays where it is.
    Hold {
        /// Length, h.
        duration_h: f64,
    },
    /// The chamber goes to a temperature.
    Ramp {
        /// Where to, °C.
        #[serde(rename = "to_degC")]
        to_degc: f64,
        /// How fast, °C/h.
        #[serde(rename = "rate_degC_per_h")]
        rate_degc_per_h: f64,
    },
    /// The chamber goes to the low temperature, then up and down again some times.
    Cycle {
        /// Low end, °C.
        #[serde(rename = "low_degC")]
        low_degc: f64,
        /// High end, °C.
        #[serde(rename = "high_degC")]
        high_degc: f64,
        /// Rate, °C/h.
        #[serde(rename = "rate_degC_per_h")]
        rate_degc_per_h: f64,
        /// Soak at each end, h.
        #[serde(default)]
        soak_h: f64,
        /// Times.
        count: u32,
    },
    /// The table turns at each of some rates in turn, then stands.
    TableRates {
        /// Rates, deg/s.
        rates_deg_s: Vec<f64>,
        /// How long each is held, s.
        dwell_s: f64,
        /// Times.
        count: u32,
    },
    /// The table dwells at each of several angles in turn.
    Headings {
        /// Angles, deg.
        angles_deg: Vec<f64>,
        /// Dwell time at each, s.
        dwell_s: f64,
        /// Times.
        count: u32,
    },
}

/// A schedule.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Schedule {
    /// Where it begins.
    pub start: Start,
    /// What follows.
    #[serde(rename = "step")]
    pub steps: Vec<Step>,
}

/// A part of a schedule in which nothing changes its pace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Its beginning, s after that of the schedule.
    pub from_s: f64,
    /// Its end, s.
    pub to_s: f64,
    /// Temperature at its beginning and end, °C.
    pub temp_degc: Option<[f64; 2]>,
    /// Rate of the table, deg/s.
    pub table_rate_deg_s: Option<f64>,
    /// Angle of the table, deg.
    pub table_angle_deg: Option<f64>,
}

impl Leg {
    /// Rate of change of the temperature, °C/h.
    pub fn ramp_degc_per_h(&self) -> f64 {
        let length_h = (self.to_s - self.from_s) / HOUR_S;
        self.temp_degc.map_or(0.0, |[from, to]| if length_h > 0.0 { (to - from) / length_h } else { 0.0 })
    }
}

/// Where chamber and table stand while the steps are gone through.
struct Walk {
    at_s: f64,
    state: Start,
    legs: Vec<Leg>,
}

impl Walk {
    fn stay(&mut self, seconds: f64) {
        self.go(self.state.temp_degc, seconds);
    }

    fn go(&mut self, to_degc: Option<f64>, seconds: f64) {
        if !(seconds > 0.0 && seconds.is_finite()) {
            self.state.temp_degc = to_degc;
            return;
        }
        let Start { temp_degc, table_rate_deg_s, table_angle_deg } = self.state;
        let temp_degc = to_degc.map(|to| [temp_degc.unwrap_or(to), to]);
        let to_s = self.at_s + seconds;
        self.legs.push(Leg { from_s: self.at_s, to_s, temp_degc, table_rate_deg_s, table_angle_deg });
        self.state.temp_degc = to_degc;
        self.at_s = to_s;
    }

    /// A ramp; from nowhere it begins where it ends.
    fn ramp(&mut self, to_degc: f64, rate_degc_per_h: f64) {
        let from = self.state.temp_degc.unwrap_or(to_degc);
        self.state.temp_degc = Some(from);
        self.go(Some(to_degc), (to_degc - from).abs() / rate_degc_per_h.abs() * HOUR_S);
    }

    fn step(&mut self, step: &Step) {
        match step {
            Step::Hold { duration_h } => self.stay(duration_h * HOUR_S),
            Step::Ramp { to_degc, rate_degc_per_h } => self.ramp(*to_degc, *rate_degc_per_h),
            Step::Cycle { low_degc, high_degc, rate_degc_per_h, soak_h, count } => {
                self.ramp(*low_degc, *rate_degc_per_h);
                for _ in 0..*count {
                    for end in [*high_degc, *low_degc] {
                        self.ramp(end, *rate_degc_per_h);
                        self.stay(soak_h * HOUR_S);
                    }
                }
            }
            Step::TableRates { rates_deg_s, dwell_s, count } => {
                for rate in (0..*count).flat_map(|_| rates_deg_s) {
                    self.state.table_rate_deg_s = Some(*rate);
                    self.stay(*dwell_s);
                }
                self.state.table_rate_deg_s = Some(0.0);
            }
            Step::Headings { angles_deg, dwell_s, count } => {
                for angle in (0..*count).flat_map(|_| angles_deg) {
                    self.state.table_angle_deg = Some(*angle);
                    self.stay(*dwell_s);
                }
            }
        }
    }
}

impl Schedule {
    /// Where it begins, with what its steps move: the table stands before it first turns, and a first ramp begins where it
    /// ends.
    fn begin(&self) -> Start {
        let mut start = self.start;
        for step in &self.steps {
            match step {
                Step::Hold { .. } => {}
                Step::Ramp { to_degc: first, .. } | Step::Cycle { low_degc: first, .. } => {
                    start.temp_degc.get_or_insert(*first);
                }
                Step::TableRates { .. } => {
                    start.table_rate_deg_s.get_or_insert(0.0);
                }
                Step::Headings { angles_deg, .. } => {
                    start.table_angle_deg.get_or_insert(angles_deg.first().copied().unwrap_or(0.0));
                }
            }
        }
        start
    }

    /// Its parts.
    pub fn legs(&self) -> Vec<Leg> {
        let mut walk = Walk { at_s: 0.0, state: self.begin(), legs: vec![] };
        self.steps.iter().for_each(|step| walk.step(step));
        walk.legs
    }

    /// Length, s.
    pub fn duration_s(&self) -> f64 {
        self.legs().last().map_or(0.0, |leg| leg.to_s)
    }

    /// The columns of a recording of it that begins at `start_s`. `noise` gives the deviation of the sensor of a column.
    pub fn profiles(&self, start_s: f64, noise: impl Fn(Column) -> f64) -> Vec<Profile> {
        let legs = self.legs();
        let profile = |column: Column, ends: &dyn Fn(&Leg) -> Option<[f64; 2]>| {
            let mut time_s = vec![];
            let mut value = vec![];
            for leg in &legs {
                let ends = ends(leg)?;
                time_s.extend([start_s + leg.from_s, start_s + leg.to_s]);
                value.extend(ends);
            }
            let noise = noise(column);
            let sine = Profile {
                column,
                time_s,
                value,
                sine_amplitude: 0.0,
                sine_period_s: 0.0,
                sine_phase_deg: 0.0,
                noise,
            };
            (!legs.is_empty()).then_some(sine)
        };
        let all = [
            profile(Column::Temperature, &|l| l.temp_degc),
            profile(Column::TableRate, &|l| l.table_rate_deg_s.map(|r| [r, r])),
            profile(Column::TableAngle, &|l| l.table_angle_deg.map(|a| [a, a])),
        ];
        all.into_iter().flatten().collect()
    }

    /// The steps after one another, equal neighbours counted together.
    #[must_use]
    pub fn joined(&self) -> Schedule {
        let mut steps: Vec<Step> = vec![];
        for step in &self.steps {
            if !steps.last_mut().is_some_and(|last| last.takes_up(step)) {
                steps.push(step.clone());
            }
        }
        Schedule { start: self.start, steps }
    }
}

impl Step {
    /// Takes up a step that does the same; false where it does something else.
    fn takes_up(&mut self, next: &Step) -> bool {
        match (self, next) {
            (Step::Hold { duration_h }, Step::Hold { duration_h: more }) => {
                *duration_h += more;
                true
            }
            (
                Step::Cycle { low_degc, high_degc, rate_degc_per_h, soak_h, count },
                Step::Cycle { low_degc: l, high_degc: h, rate_degc_per_h: r, soak_h: s, count: more },
            ) if (l, h, r, s) == (low_degc, high_degc, rate_degc_per_h, soak_h) => {
                *count += more;
                true
            }
            (
                Step::TableRates { rates_deg_s, dwell_s, count },
                Step::TableRates { rates_deg_s: r, dwell_s: d, count: more },
            ) if r == rates_deg_s && d == dwell_s => {
                *count += more;
                true
            }
            (
                Step::Headings { angles_deg, dwell_s, count },
                Step::Headings { angles_deg: a, dwell_s: d, count: more },
            ) if a == angles_deg && d == dwell_s => {
                *count += more;
                true
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycle(count: u32) -> Step {
        Step::Cycle { low_degc: 20.0, high_degc: 50.0, rate_degc_per_h: 30.0, soak_h: 0.5, count }
    }

    #[test]
    fn a_cycle_takes_two_ramps_and_two_soaks_and_its_approach() {
        let start = Start { temp_degc: Some(35.0), ..Start::default() };
        let schedule = Schedule { start, steps: vec![cycle(2)] };
        // Half an hour down to 20 °C, then twice (1 h + 0.5 h) · 2.
        assert!((schedule.duration_s() - 3600.0 * 6.5).abs() < 1e-6);
        let ramps: Vec<f64> = schedule.legs().iter().map(Leg::ramp_degc_per_h).collect();
        assert_eq!(ramps, [-30.0, 30.0, 0.0, -30.0, 0.0, 30.0, 0.0, -30.0, 0.0]);
        let profiles = schedule.profiles(100.0, |_| 0.01);
        assert_eq!(profiles.len(), 1);
        for (t, expected) in [(100.0, 35.0), (1900.0, 20.0), (3700.0, 35.0), (5500.0, 50.0), (7000.0, 50.0)] {
            assert!((profiles[0].at(t) - expected).abs() < 1e-9, "{t}: {}", profiles[0].at(t));
        }
        assert_eq!(profiles[0].noise, 0.01);
    }

    #[test]
    fn a_table_stands_before_and_after_its_rates() {
        let hold = Step::Hold { duration_h: 0.5 };
        let rates = Step::TableRates { rates_deg_s: vec![5.0, -5.0], dwell_s: 60.0, count: 1 };
        let schedule = Schedule { start: Start::default(), steps: vec![hold.clone(), rates, hold] };
        let profiles = schedule.profiles(0.0, |_| 0.0);
        let at = |t: f64| profiles[0].at(t);
        assert_eq!((at(10.0), at(1800.0), at(1830.0), at(1890.0), at(2000.0)), (0.0, 5.0, 5.0, -5.0, 0.0));
        assert_eq!(schedule.duration_s(), 3720.0);
    }

    #[test]
    fn equal_neighbours_are_counted_together() {
        let hold = Step::Hold { duration_h: 1.0 };
        let steps = vec![cycle(1), cycle(2), hold.clone(), hold, cycle(1)];
        let joined = Schedule { start: Start::default(), steps }.joined();
        assert_eq!(joined.steps, [cycle(3), Step::Hold { duration_h: 2.0 }, cycle(1)]);
    }

    #[test]
    fn headings_are_angles_at_rest() {
        let steps = vec![Step::Headings { angles_deg: vec![0.0, 90.0], dwell_s: 10.0, count: 2 }];
        let schedule = Schedule { start: Start::default(), steps };
        let angle = &schedule.profiles(0.0, |_| 0.0)[0];
        assert_eq!([5.0, 15.0, 25.0, 35.0].map(|t| angle.at(t)), [0.0, 90.0, 0.0, 90.0]);
    }
}
