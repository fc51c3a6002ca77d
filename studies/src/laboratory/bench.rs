//! A bench: an instrument with its noise and its claim, what surrounds it, and what the laboratory recorded besides.

use super::claim::{Claim, Columns};
use super::dice::Dice;
use super::environment::sensor::Sensor;
use super::environment::span::Span;
use super::environment::{chamber, magnetic, people, room, supply, weather};
use super::motion::{Motion, Programme, positions};
use super::noise::{Levels, Parts};
use super::unit::body::{Body, Pace, Warmth};
use std::collections::BTreeMap;

/// Columns that may be recorded besides; some drive nothing.
pub const SURROUNDINGS: [&str; 7] =
    ["pressure_hPa", "humidity_pct", "field_uT", "acc_x_g", "supply_v", "rack_degC", "current_mA"];

/// Everything of a recording but the effects.
pub struct Bench {
    /// Draws of this bench.
    pub dice: Dice,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Rows.
    pub rows: usize,
    /// Slow grid.
    pub span: Span,
    /// Noise, part by part.
    pub parts: Parts,
    /// What is true where the claim may err within its uncertainty.
    pub right: Claim,
    /// The claim.
    pub claim: Claim,
    /// Recorded columns.
    pub columns: Columns,
    /// True courses of recorded surroundings on the slow grid.
    pub surroundings: BTreeMap<String, Vec<f64>>,
    /// Temperatures of the unit, where a thermometer is recorded.
    pub warmth: Option<Warmth>,
    /// Motion of the table about the input axis.
    pub motion: Option<Motion>,
    /// What effects have added so far, deg/h per row.
    pub added: Vec<f64>,
}

impl Bench {
    /// A unit at rest: 2 to 12 h at 1 to 10 Hz, 20 000 to 80 000 rows.
    pub fn new(mut dice: Dice) -> Bench {
        let rate_hz = *dice.one_of(&[1.0, 2.0, 4.0, 5.0, 10.0]);
        let hours = dice
            .uniform((20_000.0 / rate_hz / 3600.0f64).max(2.0), (80_000.0 / rate_hz / 3600.0f64).min(12.0));
        Bench::of_length(dice, rate_hz, hours)
    }

    /// A unit at rest over days, for what takes a day.
    pub fn of_days(mut dice: Dice) -> Bench {
        let hours = dice.uniform(30.0, 80.0);
        Bench::of_length(dice, 0.25, hours)
    }

    /// A unit at rest with given noise and a correct claim.
    pub fn of_noise(mut dice: Dice, claim: Claim, parts: Parts) -> Bench {
        let rows = parts.white.len();
        Bench {
            span: Span::new(rows as f64 / claim.rate_hz, dice.uniform(0.0, 24.0)),
            dice,
            rate_hz: claim.rate_hz,
            rows,
            parts,
            right: claim.clone(),
            claim,
            columns: Columns::new(),
            surroundings: BTreeMap::new(),
            warmth: None,
            motion: None,
            added: vec![0.0; rows],
        }
    }

    fn of_length(mut dice: Dice, rate_hz: f64, hours: f64) -> Bench {
        let rows = (hours * 3600.0 * rate_hz / 1000.0).round() as usize * 1000;
        let levels = instrument(&mut dice);
        let levels_rel = [dice.uniform(0.008, 0.025), dice.uniform(0.06, 0.18), dice.uniform(0.08, 0.22)];
        let off = levels_rel.map(|rel| 1.0 + rel * dice.within_two());
        let claimed =
            Levels { n: short(levels.n / off[0]), b: short(levels.b / off[1]), k: short(levels.k / off[2]) };
        let bias_sd_deg_h = short(10.0 * (levels.b + levels.n));
        let bias = short(dice.sign() * dice.decades(100.0, 1000.0) * levels.n);
        let claim = Claim {
            rate_hz,
            description: "unit on its bench, static".to_owned(),
            levels: claimed,
            levels_rel: levels_rel.map(short),
            bias_deg_h: bias,
            bias_sd_deg_h,
            temperature: None,
            scale_ppm: None,
            earth_deg: None,
        };
        let right = Claim { levels, bias_deg_h: bias + bias_sd_deg_h * dice.within_two(), ..claim.clone() };
        let parts = Parts::draw(&mut dice.fork(), levels, rows, rate_hz);
        Bench {
            span: Span::new(rows as f64 / rate_hz, dice.uniform(0.0, 24.0)),
            dice,
            rate_hz,
            rows,
            parts,
            right,
            claim,
            columns: Columns::new(),
            surroundings: BTreeMap::new(),
            warmth: None,
            motion: None,
            added: vec![0.0; rows],
        }
    }

    /// Middle of each sampling interval, s.
    pub fn time_s(&self) -> Vec<f64> {
        (0..self.rows).map(|i| (i as f64 + 0.5) / self.rate_hz).collect()
    }

    /// Length, s.
    pub fn duration_s(&self) -> f64 {
        self.rows as f64 / self.rate_hz
    }

    /// A slow course at the rows.
    pub fn at_rows(&self, course: &[f64]) -> Vec<f64> {
        self.span.at(course, &self.time_s())
    }

    /// The rate with what was added so far, deg/h.
    pub fn rate(&self) -> Vec<f64> {
        let mean = self.right.mean(&self.columns, self.rows);
        (0..self.rows).zip(self.parts.sum()).map(|(i, noise)| mean[i] + noise + self.added[i]).collect()
    }

    /// The residual of the claim without any effect, deg/h.
    pub fn residual(&self) -> Vec<f64> {
        let claimed = self.claim.mean(&self.columns, self.rows);
        let rate = self.rate();
        (0..self.rows).map(|i| rate[i] - self.added[i] - claimed[i]).collect()
    }

    /// Puts the unit in a chamber, or leaves it in the room, and records its thermometer.
    pub fn warm(&mut self, in_chamber: bool, pace: Pace) {
        let mut dice = self.dice.fork();
        let air = if in_chamber {
            let low = dice.uniform(-30.0, 15.0);
            let high = low + dice.uniform(15.0, 50.0);
            let (start, legs) = chamber::programme(&mut dice, self.duration_s(), low, high);
            self.claim.description = "static, in the chamber".to_owned();
            chamber::air(&mut dice, &self.span, start, &legs)
        } else {
            let outside = weather::weather(&mut dice, &self.span).outside_deg_c;
            room::air(&mut dice, &self.span, &outside)
        };
        let warmth = Body::draw(&mut dice, pace).run(&self.span, &air, false);
        let thermometer = Sensor {
            lag_s: dice.uniform(2.0, 10.0),
            noise: dice.decades(0.001, 0.01),
            resolution: *dice.one_of(&[0.001, 0.005, 0.01]),
        };
        let seen = thermometer.read(&mut dice, &self.span, &warmth.housing, &self.time_s());
        self.columns.insert("temp_degC".to_owned(), seen);
        let typical = self.right.levels.b + 0.3 * self.right.levels.n;
        let coefficient = short(dice.sign() * dice.decades(0.003, 0.05) * typical);
        let sd = short(0.01 * coefficient.abs());
        self.claim.temperature = Some([coefficient, 20.0, sd]);
        self.right.temperature = Some([coefficient + sd * dice.within_two(), 20.0, sd]);
        self.warmth = Some(warmth);
    }

    /// Puts the unit on a moving table and records its rate.
    pub fn turn(&mut self, programme: Programme) {
        let mut dice = self.dice.fork();
        let motion = Motion::draw(&mut dice, programme, self.rows, self.rate_hz);
        let seen = motion.rate_deg_s().into_iter().map(|r| (r * 1e8).round() / 1e8).collect();
        self.columns.insert("table_rate_deg_s".to_owned(), seen);
        let (ppm, sd) = (short(dice.sign() * dice.decades(1.0, 100.0)), short(dice.uniform(0.5, 3.0)));
        self.claim.scale_ppm = Some([ppm, sd]);
        self.right.scale_ppm = Some([ppm + sd * dice.within_two(), sd]);
        self.claim.description = "rate table".to_owned();
        self.motion = Some(motion);
    }

    /// Puts the unit level on an indexing table; the claim knows the heading or leaves the Earth out.
    pub fn index(&mut self, claims_earth: bool) {
        let mut dice = self.dice.fork();
        let angle = positions(&mut dice, self.rows, self.rate_hz);
        self.columns.insert("table_angle_deg".to_owned(), angle);
        let earth = [short(dice.uniform(35.0, 65.0)), short(dice.uniform(0.0, 360.0))];
        self.right.earth_deg = Some(earth);
        self.claim.earth_deg = claims_earth.then_some(earth);
        self.claim.description = "positions of the indexing table".to_owned();
    }

    /// Records a surrounding quantity and keeps its true course.
    pub fn record(&mut self, name: &str) {
        let mut dice = self.dice.fork();
        let (course, sensor) = surrounding(name, &mut dice, &self.span);
        let seen = sensor.read(&mut dice, &self.span, &course, &self.time_s());
        self.columns.insert(name.to_owned(), seen);
        self.surroundings.insert(name.to_owned(), course);
    }

    /// Records some of the quantities that are not recorded yet.
    pub fn record_others(&mut self, count: usize) {
        let mut names: Vec<&str> =
            SURROUNDINGS.into_iter().filter(|n| !self.columns.contains_key(*n)).collect();
        self.dice.shuffle(&mut names);
        names.into_iter().take(count).for_each(|name| self.record(name));
    }
}

/// N, B and K of an instrument: fibre-optic for navigation or for lower demands, ring laser, micromechanical.
fn instrument(dice: &mut Dice) -> Levels {
    let (n, b, k) = match dice.count(0, 3) {
        0 => (dice.decades(5e-4, 5e-3), dice.decades(0.3, 1.5), dice.decades(0.1, 1.5)),
        1 => (dice.decades(0.01, 0.1), dice.decades(0.3, 2.0), dice.decades(0.2, 2.0)),
        2 => (dice.decades(1e-3, 5e-3), dice.decades(0.1, 0.5), dice.decades(0.05, 0.3)),
        _ => (dice.decades(0.1, 0.6), dice.decades(3.0, 20.0), dice.decades(2.0, 20.0)),
    };
    Levels { n, b: n * b, k: n * k }
}

/// Course and sensor of a quantity.
fn surrounding(name: &str, dice: &mut Dice, span: &Span) -> (Vec<f64>, Sensor) {
    let sensor = |lag_s, noise, resolution| Sensor { lag_s, noise, resolution };
    match name {
        "pressure_hPa" => (weather::weather(dice, span).pressure_hpa, sensor(1.0, 0.01, 0.01)),
        "humidity_pct" => (weather::weather(dice, span).humidity_pct, sensor(8.0, 0.05, 0.05)),
        "field_uT" => (magnetic::field(dice, span), sensor(0.0, 0.005, 0.002)),
        "acc_x_g" => {
            let tilt = dice.uniform(-0.01, 0.01);
            let floor = dice.decades(2e-5, 3e-4);
            let level = people::shaking(dice, span, floor);
            let course = level.iter().map(|l| tilt + l * dice.normal()).collect();
            (course, sensor(0.0, 2e-5, 1e-5))
        }
        "supply_v" => (supply::voltage(dice, span), sensor(0.0, 2e-4, 1e-4)),
        "rack_degC" => {
            let outside = weather::weather(dice, span).outside_deg_c;
            let heat = dice.uniform(4.0, 12.0);
            (room::air(dice, span, &outside).iter().map(|t| t + heat).collect(), sensor(60.0, 0.02, 0.0625))
        }
        _ => {
            let volts = supply::voltage(dice, span);
            let (level, gain) = (dice.uniform(80.0, 200.0), dice.uniform(3.0, 15.0));
            (
                volts.iter().map(|v| level + gain * (v / volts[0] - 1.0) * 100.0).collect(),
                sensor(0.0, 0.05, 0.02),
            )
        }
    }
}

/// Rounded to four digits, as a person writes it.
pub fn short(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = 10f64.powi(3 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::oracle::Oracle;

    #[test]
    fn the_residual_of_a_right_claim_is_standard_normal_mode_by_mode() {
        let scenes: [fn(&mut Bench); 5] = [
            |b| b.record_others(5),
            |b| b.warm(true, Pace::Quick),
            |b| b.turn(Programme::Steps),
            |b| b.turn(Programme::Swings),
            |b| b.index(true),
        ];
        let (mut low, mut of) = (0.0, 0.0);
        for (seed, scene) in (100u64..).zip(scenes) {
            let mut bench = Bench::new(Dice::new(seed));
            scene(&mut bench);
            // What is true within the uncertainties takes the place of the claim.
            bench.claim = bench.right.clone();
            let white = Oracle::new(&bench.claim, &bench.columns, &bench.residual()).whitened();
            let n = white.len() as f64;
            let moment = |p: i32| white.iter().map(|x| x.powi(p)).sum::<f64>() / n;
            assert!(moment(1).abs() < 5.0 / n.sqrt(), "{seed}: {}", moment(1));
            assert!((moment(2) - 1.0).abs() < 0.01 + 5.0 * (2.0 / n).sqrt(), "{seed}: {}", moment(2));
            assert!((moment(4) - 3.0).abs() < 0.05 + 5.0 * (96.0 / n).sqrt(), "{seed}: {}", moment(4));
            low += white[..200].iter().map(|x| x * x).sum::<f64>();
            of += 200.0;
        }
        // The slow modes, where flicker and random walk rule.
        assert!((low / of - 1.0).abs() < 4.5 * (2.0f64 / of).sqrt(), "{}", low / of);
    }
}
