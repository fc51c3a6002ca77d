//! Courses of columns that a model file gives for simulation.

use crate::effect::Column;

/// What `simulate` makes when the command line does not say.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SimulationPlan {
    /// Length, s.
    pub duration_s: Option<f64>,
    /// Seed.
    pub seed: Option<u64>,
    /// `time_s` of the first sample, s.
    pub start_s: f64,
}

/// The course of a column.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The column.
    pub column: Column,
    /// Times of the points on `time_s`, s, rising.
    pub time_s: Vec<f64>,
    /// Values there, in the unit of the column.
    pub value: Vec<f64>,
    /// Amplitude of the sine, in the unit of the column.
    pub sine_amplitude: f64,
    /// Period of the sine, s; 0 for none.
    pub sine_period_s: f64,
    /// Phase of the sine at `time_s` = 0, deg.
    pub sine_phase_deg: f64,
    /// Standard deviation of the noise of the sensor, in the unit of the column.
    pub noise: f64,
}

impl Profile {
    /// The value at `t_s` on `time_s`, without the noise of the sensor. At a step the later value holds.
    pub fn at(&self, t_s: f64) -> f64 {
        let sine = if self.sine_amplitude != 0.0 && self.sine_period_s > 0.0 {
            let turns = (t_s / self.sine_period_s).rem_euclid(1.0);
            self.sine_amplitude * (turns * std::f64::consts::TAU + self.sine_phase_deg.to_radians()).sin()
        } else {
            0.0
        };
        self.between_points(t_s) + sine
    }

    fn between_points(&self, t_s: f64) -> f64 {
        let next = self.time_s.partition_point(|t| *t <= t_s);
        let value = |i: usize| self.value.get(i).copied();
        let Some(before) = next.checked_sub(1) else { return value(0).unwrap_or(0.0) };
        match (self.time_s.get(before), self.time_s.get(next), value(before), value(next)) {
            (Some(t0), Some(t1), Some(v0), Some(v1)) if t1 > t0 => v0 + (v1 - v0) * (t_s - t0) / (t1 - t0),
            (_, _, Some(v0), _) => v0,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(time_s: &[f64], value: &[f64]) -> Profile {
        Profile {
            column: Column::Temperature,
            time_s: time_s.to_vec(),
            value: value.to_vec(),
            sine_amplitude: 0.0,
            sine_period_s: 0.0,
            sine_phase_deg: 0.0,
            noise: 0.0,
        }
    }

    #[test]
    fn lines_join_the_points_and_the_ends_are_held() {
        let p = profile(&[10.0, 20.0, 40.0], &[1.0, 3.0, -1.0]);
        for (t, v) in
            [(0.0, 1.0), (10.0, 1.0), (15.0, 2.0), (20.0, 3.0), (30.0, 1.0), (40.0, -1.0), (90.0, -1.0)]
        {
            assert_eq!(p.at(t), v, "{t}");
        }
    }

    #[test]
    fn two_points_at_one_time_are_a_step() {
        let p = profile(&[0.0, 5.0, 5.0, 9.0], &[1.0, 1.0, 7.0, 7.0]);
        assert_eq!((p.at(4.999), p.at(5.0), p.at(8.0)), (1.0, 7.0, 7.0));
    }

    #[test]
    fn a_sine_stands_on_the_lines() {
        let p = Profile {
            sine_amplitude: 2.0,
            sine_period_s: 8.0,
            sine_phase_deg: 90.0,
            ..profile(&[0.0], &[5.0])
        };
        for (t, v) in [(0.0, 7.0), (2.0, 5.0), (4.0, 3.0), (8.0, 7.0), (-8.0, 7.0)] {
            assert!((p.at(t) - v).abs() < 1e-12, "{t}: {}", p.at(t));
        }
    }
}
