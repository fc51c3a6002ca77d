//! Temperatures: a chamber that follows a programme, and the gyro's housing that follows the chamber.

use super::draw::Draw;
use super::profile::Profile;

/// Points of the solution over the record.
const POINTS: usize = 16_000;

/// The solved course of the housing's temperature, from before the record to its end.
#[derive(Clone, Debug)]
pub struct Thermal {
    start_s: f64,
    step_s: f64,
    housing_c: Vec<f64>,
}

/// A function known on an even grid, read between the points.
pub fn read(grid: &[f64], start_s: f64, step_s: f64, t: f64) -> f64 {
    let x = ((t - start_s) / step_s).clamp(0.0, (grid.len() - 1) as f64);
    let i = (x as usize).min(grid.len() - 2);
    grid[i] + (x - i as f64) * (grid[i + 1] - grid[i])
}

impl Thermal {
    /// Solves dT/dt = (chamber − T)/τ for the air and for the housing, air stirred by slow random heat.
    pub fn solve(
        draw: &mut Draw,
        duration_s: f64,
        programme: &Profile,
        air_s: f64,
        housing_s: f64,
    ) -> Thermal {
        let step_s = duration_s / POINTS as f64;
        let start_s = -0.4 * duration_s;
        let count = (1.4 * POINTS as f64) as usize + 200;
        let (mut air, mut housing) = (programme.at(start_s), programme.at(start_s));
        let mut stir = 0.0;
        let stir_s = draw.uniform(300.0, 900.0);
        let keep = (-step_s / stir_s).exp();
        let mut housing_c = Vec::with_capacity(count);
        for i in 0..count {
            housing_c.push(housing);
            let t = start_s + step_s * (i as f64 + 0.5);
            stir = keep * stir + 0.03 * (1.0 - keep * keep).sqrt() * draw.normal();
            let before = air;
            air += (programme.at(t) + stir - air) * (1.0 - (-step_s / air_s).exp());
            housing += (0.5 * (before + air) - housing) * (1.0 - (-step_s / housing_s).exp());
        }
        Thermal { start_s, step_s, housing_c }
    }

    /// Housing temperature, °C.
    pub fn at(&self, t: f64) -> f64 {
        read(&self.housing_c, self.start_s, self.step_s, t)
    }

    /// Rate of change, °C per minute.
    pub fn rate(&self, t: f64) -> f64 {
        let h = self.step_s;
        60.0 * (self.at(t + h) - self.at(t - h)) / (2.0 * h)
    }

    /// The housing temperature behind a first-order lag, on the times given.
    pub fn lagged(&self, times: &[f64], lag_s: f64) -> Vec<f64> {
        let keep = (-self.step_s / lag_s).exp();
        let mut at = self.housing_c[0];
        let mut out = Vec::with_capacity(self.housing_c.len());
        let mut before = at;
        for &now in &self.housing_c {
            // The input is a straight line over the step.
            let slope = (now - before) / self.step_s;
            at = now - slope * lag_s + (at - before + slope * lag_s) * keep;
            out.push(at);
            before = now;
        }
        times.iter().map(|&t| read(&out, self.start_s, self.step_s, t)).collect()
    }

    /// What a play of half-width `half_c` makes of the temperature, relative to it: −1 on the way up, +1 on the way down.
    pub fn play(&self, times: &[f64], half_c: f64) -> Vec<f64> {
        let mut at = self.housing_c[0];
        let side: Vec<f64> = self
            .housing_c
            .iter()
            .map(|&t| {
                at = at.clamp(t - half_c, t + half_c);
                (at - t) / half_c
            })
            .collect();
        times.iter().map(|&t| read(&side, self.start_s, self.step_s, t)).collect()
    }
}

/// A programme of soaks and ramps over a range of temperatures, with a turn back when `cycles` asks for it.
pub fn programme(draw: &mut Draw, duration_s: f64, cycles: bool) -> Profile {
    let low = draw.uniform(-20.0, 20.0);
    let span = draw.uniform(10.0, 40.0);
    let count = 3 + draw.below(4);
    let mut targets = vec![low];
    for i in 1..=count {
        let up = if cycles { i % 2 == 1 } else { draw.chance(0.6) };
        let next = if up { draw.uniform(0.6, 1.0) } else { draw.uniform(0.0, 0.3) };
        targets.push(low + span * next);
    }
    let share = duration_s / (count as f64 + 0.5);
    let mut points = vec![(-2.0 * duration_s, targets[0])];
    let mut at = share * draw.uniform(0.2, 0.4);
    for pair in targets.windows(2) {
        let ramp = share * draw.uniform(0.3, 0.7);
        points.push((at, pair[0]));
        points.push((at + ramp, pair[1]));
        at += ramp + share * draw.uniform(0.2, 0.4);
    }
    Profile::new(&points)
}
