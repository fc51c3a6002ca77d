//! What acts on the gyro and is recorded beside it: temperature, table, headings, second axis, supply.

use super::draw::Draw;
use super::profile::{Profile, levels};
use super::scenario::Scenario;
use super::thermal::{Thermal, programme};

/// The true courses, and how their sensors spoil them.
#[derive(Clone, Debug, Default)]
pub struct Drivers {
    pub description: &'static str,
    pub thermal: Option<Thermal>,
    /// Table rate about the input axis, deg/s.
    pub table: Option<Profile>,
    /// Rate of turning between headings, deg/s, and the angle at time 0, deg.
    pub heading: Option<(Profile, f64)>,
    /// Rate of the other axis, deg/s.
    pub outer: Option<Profile>,
    /// Supply voltage, V.
    pub supply: Option<Profile>,
    /// A thermometer beside a gyro of which nothing is said about temperature.
    pub idle_thermal: Option<Thermal>,
}

/// Steps of rate up to `top`, plus and minus, zero among them; `passage_s` lasts the change from one to the next.
fn rate_steps(draw: &mut Draw, duration_s: f64, top: f64, passage_s: f64) -> Profile {
    let count = 6 + draw.below(10);
    let mut values = vec![0.0, top];
    for _ in 0..count {
        values.push(top * draw.uniform(-1.0, 1.0));
    }
    values.extend([-top, 0.0, 0.02 * top, -0.03 * top, 0.0]);
    let first = draw.below(3);
    values.rotate_left(first);
    levels(draw, duration_s, &values, passage_s)
}

/// Headings at multiples of 45° in random order: the rate of turning, whose integral is the angle.
fn headings(draw: &mut Draw, duration_s: f64) -> Profile {
    let count = 5 + draw.below(6);
    let share = duration_s / (count as f64 + 1.0);
    let mut points = vec![(-duration_s, 0.0)];
    for i in 0..count {
        let at = share * (i as f64 + 1.0 + draw.uniform(-0.2, 0.2));
        let turn = 45.0 * draw.sign() * (1 + draw.below(4)) as f64;
        let ramp = (0.02 * share).min(5.0);
        let flat = (0.1 * share).min(30.0);
        let rate = turn / (flat + ramp);
        points.extend([
            (at, 0.0),
            (at + ramp, rate),
            (at + ramp + flat, rate),
            (at + flat + 2.0 * ramp, 0.0),
        ]);
    }
    Profile::new(&points)
}

/// A supply of about 5 V that wanders and is stepped.
fn supply(draw: &mut Draw, duration_s: f64) -> Profile {
    let nominal = *draw.pick(&[5.0, 12.0, 27.0]);
    let mut points = Vec::new();
    let (mut level, mut wander) = (0.0, 0.0);
    for i in -20..=150 {
        if draw.chance(0.07) {
            level = 0.05 * nominal * draw.uniform(-1.0, 1.0);
        }
        wander = 0.9 * wander + 0.003 * nominal * draw.normal();
        points.push((duration_s * f64::from(i) / 150.0, nominal + level + wander));
    }
    Profile::new(&points)
}

fn thermal(draw: &mut Draw, duration_s: f64, cycles: bool) -> Thermal {
    let told = programme(draw, duration_s, cycles);
    let air_s = draw.uniform(60.0, 240.0);
    let housing_s = draw.uniform(0.01, 0.05) * duration_s;
    Thermal::solve(draw, duration_s, &told, air_s, housing_s)
}

/// The drivers of a scenario.
pub fn drive(draw: &mut Draw, scenario: Scenario, duration_s: f64, rate_hz: f64) -> Drivers {
    let mut d = Drivers::default();
    let passage_s = draw.uniform(0.5, 10.0).max(20.0 / rate_hz);
    match scenario {
        Scenario::Static => d.description = "static, laboratory",
        Scenario::Days => d.description = "static, several days",
        Scenario::Fixed => {
            d.description = "static, at one heading";
            d.heading = Some((Profile::new(&[(-1.0, 0.0), (1.0, 0.0)]), draw.uniform(0.0, 360.0)));
        }
        Scenario::Thermal | Scenario::Cycles => {
            d.description = "static, chamber with ramps and soaks";
            d.thermal = Some(thermal(draw, duration_s, scenario == Scenario::Cycles));
        }
        Scenario::Rates | Scenario::RatesThermal => {
            d.description = "rate steps";
            let top = *draw.pick(&[1.0, 10.0, 30.0, 100.0]);
            d.table = Some(rate_steps(draw, duration_s, top, passage_s));
            if scenario == Scenario::RatesThermal {
                d.description = "rate steps in the chamber";
                d.thermal = Some(thermal(draw, duration_s, false));
            }
        }
        Scenario::Slow => {
            d.description = "slow rate steps";
            let top = draw.uniform(0.004, 0.03);
            d.table = Some(rate_steps(draw, duration_s, top, passage_s));
        }
        Scenario::Headings => {
            d.description = "positions of the table";
            d.heading = Some((headings(draw, duration_s), draw.uniform(0.0, 360.0)));
        }
        Scenario::Revolutions => {
            d.description = "revolutions of the table";
            let top = draw.uniform(0.01, 0.04) * rate_hz * 360.0 / 8.0;
            let values = [0.0, 0.5 * top, top, -top, -0.3 * top];
            d.table = Some(levels(draw, duration_s, &values, passage_s));
            d.heading = Some((d.table.clone().expect("just set"), draw.uniform(0.0, 360.0)));
        }
        Scenario::Supply => {
            d.description = "supply varied";
            d.supply = Some(supply(draw, duration_s));
        }
        Scenario::Outer => {
            d.description = "other axis turned";
            let top = *draw.pick(&[0.1, 1.0, 10.0]);
            d.outer = Some(rate_steps(draw, duration_s, top, passage_s));
        }
        Scenario::Combined => {
            d.description = "chamber and supply varied";
            d.thermal = Some(thermal(draw, duration_s, false));
            d.supply = Some(supply(draw, duration_s));
        }
    }
    d
}

impl Drivers {
    /// Columns that do nothing, in a part of the cases.
    pub fn decoys(&mut self, draw: &mut Draw, duration_s: f64, scenario: Scenario) {
        if self.supply.is_none() && draw.chance(0.2) {
            self.supply = Some(supply(draw, duration_s));
        }
        if self.thermal.is_none() && draw.chance(0.25) {
            let base = draw.uniform(18.0, 24.0);
            let mut points = vec![(-duration_s, base)];
            points.extend((0..24).map(|i| (duration_s * f64::from(i) / 23.0, base + 0.4 * draw.normal())));
            let housing_s = 0.02 * duration_s;
            self.idle_thermal =
                Some(Thermal::solve(draw, duration_s, &Profile::new(&points), 120.0, housing_s));
        }
        if self.outer.is_none() && scenario == Scenario::Rates && draw.chance(0.3) {
            self.outer = Some(rate_steps(draw, duration_s, 5.0, 5.0));
        }
    }

    /// The thermometer's truth.
    pub fn any_thermal(&self) -> Option<&Thermal> {
        self.thermal.as_ref().or(self.idle_thermal.as_ref())
    }

    /// Names of the columns, in the order of the file.
    pub fn columns(&self) -> Vec<&'static str> {
        let mut names = vec!["time_s", "rate_deg_h"];
        let others = [
            (self.any_thermal().is_some(), "temp_degC"),
            (self.table.is_some(), "table_rate_deg_s"),
            (self.heading.is_some(), "table_angle_deg"),
            (self.outer.is_some(), "outer_rate_deg_s"),
            (self.supply.is_some(), "supply_v"),
        ];
        names.extend(others.iter().filter(|(there, _)| *there).map(|(_, name)| *name));
        names
    }

    /// Table angle, deg, not taken to 0 … 360.
    pub fn heading_deg(&self, t: f64) -> f64 {
        self.heading
            .as_ref()
            .map_or(0.0, |(turning, start)| start + turning.integral(t) - turning.integral(0.0))
    }
}
