//! Drivers of the rate: the columns of a recording on a uniform grid, and the mean that a claim expects of them.

use super::Column;
use crate::units::EARTH_RATE_DEG_H;

/// Claimed dependence on temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Temperature {
    /// deg/h/°C.
    pub coefficient_deg_h_per_degc: f64,
    /// °C.
    pub reference_degc: f64,
}

/// Direction of the input axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earth {
    /// Geographic latitude, deg.
    pub latitude_deg: f64,
    /// Heading of the input axis at table angle 0, deg.
    pub azimuth_deg: f64,
}

/// The mean of the rate as a claim states it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ClaimedMean {
    /// deg/h.
    pub bias_deg_h: f64,
    /// Dependence on temperature.
    pub temperature: Option<Temperature>,
    /// Known error of the scale factor, ppm. `None` where the claim does not speak of a table.
    pub scale_factor_ppm: Option<f64>,
    /// Earth rate in the table plane.
    pub earth: Option<Earth>,
}

/// A line that a claim states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedLine {
    /// Hz.
    pub frequency_hz: f64,
    /// deg/h.
    pub amplitude_deg_h: f64,
    /// Of its cosine at `time_s` = 0, deg.
    pub phase_deg: f64,
}

/// A column without a role of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherDriver {
    /// The column.
    pub column: Column,
    /// Its values, in the unit of its file, one a sample.
    pub values: Vec<f64>,
    /// The same without the noise of its sensor, as far as its spectrum separates them.
    pub smooth: Vec<f64>,
}

/// The columns of a recording on a uniform grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drivers {
    /// Sample interval, s.
    pub dt_s: f64,
    /// `time_s` of the first sample.
    pub start_s: f64,
    /// Samples of the grid.
    pub samples: usize,
    /// Number of samples of the recording that one sample of the grid averages.
    pub averaged: usize,
    /// °C.
    pub temperature: Option<Vec<f64>>,
    /// Temperature without the noise of its sensor, as far as its spectrum separates them, °C.
    pub smooth_temperature: Option<Vec<f64>>,
    /// deg/s.
    pub table_rate: Option<Vec<f64>>,
    /// deg.
    pub table_angle: Option<Vec<f64>>,
    /// deg/s.
    pub outer_rate: Option<Vec<f64>>,
    /// V.
    pub supply: Option<Vec<f64>>,
    /// Columns without a role of their own, each in the unit of its file.
    pub others: Vec<OtherDriver>,
    /// The mean that the claim expects.
    pub claim: ClaimedMean,
    /// The lines that the claim states.
    pub lines: Vec<StatedLine>,
}

impl Drivers {
    /// `time_s` of a sample.
    pub fn time_s(&self, i: usize) -> f64 {
        self.start_s + i as f64 * self.dt_s
    }

    /// Length of the grid, s.
    pub fn length_s(&self) -> f64 {
        self.samples as f64 * self.dt_s
    }

    /// The grid and the claim without the columns.
    pub fn bare(&self) -> Drivers {
        Drivers {
            dt_s: self.dt_s,
            start_s: self.start_s,
            samples: self.samples,
            averaged: self.averaged,
            claim: self.claim,
            lines: self.lines.clone(),
            ..Drivers::default()
        }
    }

    /// A column, if there.
    pub fn column(&self, column: Column) -> Option<&[f64]> {
        match column {
            Column::Temperature => self.temperature.as_deref(),
            Column::TableRate => self.table_rate.as_deref(),
            Column::TableAngle => self.table_angle.as_deref(),
            Column::OuterRate => self.outer_rate.as_deref(),
            Column::Supply => self.supply.as_deref(),
            Column::Other(_) => self.others.iter().find(|o| o.column == column).map(|o| o.values.as_slice()),
        }
    }

    /// The columns that are there: those with a role of their own first.
    pub fn columns(&self) -> impl Iterator<Item = Column> {
        let known = Column::KNOWN.into_iter().filter(|c| self.column(*c).is_some());
        known.chain(self.others.iter().map(|o| o.column))
    }

    /// A series for each sample from its time in seconds since the first.
    pub fn of_time(&self, mut f: impl FnMut(f64) -> f64) -> Vec<f64> {
        (0..self.samples).map(|i| f(i as f64 * self.dt_s)).collect()
    }

    /// Rate that the claim expects, without the bias, deg/h.
    pub fn claimed_mean(&self) -> Vec<f64> {
        let mut mean = vec![0.0; self.samples];
        if let (Some(claimed), Some(temperature)) = (self.claim.temperature, &self.temperature) {
            for (m, t) in mean.iter_mut().zip(temperature) {
                *m += claimed.coefficient_deg_h_per_degc * (t - claimed.reference_degc);
            }
        }
        if let Some(rate) = &self.table_rate {
            let gain = 3600.0 * (1.0 + 1e-6 * self.claim.scale_factor_ppm.unwrap_or(0.0));
            for (m, r) in mean.iter_mut().zip(rate) {
                *m += gain * r;
            }
        }
        if let (Some(earth), Some(angle)) = (self.claim.earth, &self.table_angle) {
            let horizontal = EARTH_RATE_DEG_H * earth.latitude_deg.to_radians().cos();
            for (m, a) in mean.iter_mut().zip(angle) {
                *m += horizontal * (a + earth.azimuth_deg).to_radians().cos();
            }
        }
        mean
    }

    /// Leaves out what follows the first `samples`.
    pub fn truncate(&mut self, samples: usize) {
        self.samples = self.samples.min(samples);
        let columns = [
            &mut self.temperature,
            &mut self.smooth_temperature,
            &mut self.table_rate,
            &mut self.table_angle,
            &mut self.outer_rate,
            &mut self.supply,
        ];
        columns.into_iter().flatten().for_each(|c| c.truncate(samples));
        for other in &mut self.others {
            other.values.truncate(samples);
            other.smooth.truncate(samples);
        }
    }

    /// The same on averages over `m` samples; a last incomplete group is left out. Angles are not averaged: their
    /// column is left out.
    #[must_use]
    pub fn averages(&self, m: usize) -> Drivers {
        if m <= 1 {
            return self.clone();
        }
        let means = |column: &Option<Vec<f64>>| column.as_ref().map(|c| averages(c, m));
        Drivers {
            dt_s: self.dt_s * m as f64,
            start_s: self.start_s + 0.5 * (m - 1) as f64 * self.dt_s,
            samples: self.samples / m,
            averaged: self.averaged * m,
            temperature: means(&self.temperature),
            smooth_temperature: means(&self.smooth_temperature),
            table_rate: means(&self.table_rate),
            table_angle: None,
            outer_rate: means(&self.outer_rate),
            supply: means(&self.supply),
            others: self
                .others
                .iter()
                .map(|o| OtherDriver {
                    column: o.column,
                    values: averages(&o.values, m),
                    smooth: averages(&o.smooth, m),
                })
                .collect(),
            claim: self.claim,
            lines: self.lines.clone(),
        }
    }
}

/// Means of groups of `m`; a last incomplete group is left out.
pub fn averages(values: &[f64], m: usize) -> Vec<f64> {
    values.chunks_exact(m.max(1)).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_claimed_mean_is_the_sum_of_what_a_claim_states() {
        let claim = ClaimedMean {
            bias_deg_h: 7.0,
            temperature: Some(Temperature { coefficient_deg_h_per_degc: 0.5, reference_degc: 20.0 }),
            scale_factor_ppm: Some(100.0),
            earth: Some(Earth { latitude_deg: 60.0, azimuth_deg: 90.0 }),
        };
        let drivers = Drivers {
            dt_s: 1.0,
            samples: 2,
            temperature: Some(vec![20.0, 26.0]),
            table_rate: Some(vec![0.0, 1.0]),
            table_angle: Some(vec![0.0, -90.0]),
            claim,
            ..Drivers::default()
        };
        // East sees nothing of the Earth rate; north half of it at 60°. The bias is not in it.
        let mean = drivers.claimed_mean();
        assert!(mean[0].abs() < 1e-12, "{mean:?}");
        assert!((mean[1] - (3.0 + 3600.36 + 0.5 * 15.041_067)).abs() < 1e-5, "{mean:?}");
    }

    #[test]
    fn averages_are_placed_in_the_middle_of_their_samples() {
        let drivers = Drivers {
            dt_s: 0.5,
            start_s: 10.0,
            samples: 7,
            averaged: 1,
            supply: Some((0..7).map(f64::from).collect()),
            table_angle: Some(vec![1.0; 7]),
            ..Drivers::default()
        };
        let means = drivers.averages(3);
        assert_eq!((means.samples, means.averaged, means.dt_s, means.time_s(1)), (2, 3, 1.5, 12.0));
        assert_eq!(means.supply, Some(vec![1.0, 4.0]));
        assert!(means.table_angle.is_none());
        assert_eq!(drivers.averages(1), drivers);
        let mut cut = drivers.clone();
        cut.truncate(2);
        assert_eq!((cut.samples, cut.supply), (2, Some(vec![0.0, 1.0])));
    }
}
