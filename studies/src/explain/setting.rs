//! A day at the bench: how long, at which rate, with which channels; the claim about it and the truth behind it.

use super::claim::{Claim, Departure, EARTH_DEG_H, Uncertainty, rounded};
use super::draw::Draw;
use super::drivers::{Drivers, drive};
use super::scenario::Scenario;

/// One recording's circumstances.
#[derive(Clone, Debug)]
pub struct Setting {
    /// What varies in the recording.
    pub scenario: Scenario,
    /// Rows of the recording.
    pub rows: usize,
    /// The claim.
    pub claim: Claim,
    /// Where the truth departs from it.
    pub departure: Departure,
    /// Centres of the sampling intervals, s.
    pub time_s: Vec<f64>,
    /// Courses of what is recorded beside the rate.
    pub drivers: Drivers,
}

/// Sample rates of the trade, Hz.
const RATES_HZ: [f64; 12] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 125.0, 200.0];

/// Shortest and longest record of a scenario, h.
fn durations_h(scenario: Scenario) -> (f64, f64) {
    match scenario {
        Scenario::Static => (0.05, 72.0),
        Scenario::Days => (36.0, 120.0),
        Scenario::Thermal | Scenario::Cycles | Scenario::RatesThermal | Scenario::Combined => (1.5, 24.0),
        Scenario::Rates | Scenario::Outer | Scenario::Revolutions => (0.15, 6.0),
        Scenario::Slow => (0.1, 2.0),
        Scenario::Headings | Scenario::Fixed => (0.3, 10.0),
        Scenario::Supply => (0.3, 12.0),
    }
}

fn size(draw: &mut Draw, scenario: Scenario) -> (usize, f64) {
    let (shortest, longest) = durations_h(scenario);
    for _ in 0..200 {
        let rows =
            if draw.chance(0.1) { draw.log_uniform(6.0e4, 2.0e5) } else { draw.log_uniform(6.0e3, 6.0e4) };
        let rate_hz = *draw.pick(&RATES_HZ);
        let hours = rows / rate_hz / 3600.0;
        let slow_enough = scenario != Scenario::Slow || rate_hz >= 10.0;
        if (shortest..longest).contains(&hours) && slow_enough {
            return (rows as usize, rate_hz);
        }
    }
    (20_000, 20_000.0 / (3600.0 * (shortest * longest).sqrt()))
}

fn noise(draw: &mut Draw, claim: &mut Claim, duration_s: f64) {
    claim.n = rounded(draw.log_uniform(5e-4, 0.3), 3);
    let white = 60.0 * claim.n;
    // Where flicker and walk would meet the white floor: some beyond the record, some well inside it.
    let flicker_hz = draw.log_uniform(0.02 / duration_s, 0.02 * claim.rate_hz);
    let walk_hz = draw.log_uniform(0.02 / duration_s, 20.0 / duration_s);
    // No gyro of the trade has more than some tens of its N as B or K: a short record shows neither.
    let most = 30.0 * claim.n;
    claim.b = rounded((white * (std::f64::consts::TAU * flicker_hz).sqrt()).min(most), 3);
    claim.k = rounded((white * 60.0 * std::f64::consts::TAU * walk_hz).min(most), 3);
}

impl Setting {
    /// Draws circumstances, claim and true nuisances. Streams: `setting` of the seed.
    pub fn drawn(seed: u64, scenario: Scenario) -> Setting {
        let mut draw = Draw::new(seed, "setting");
        let (rows, rate_hz) = size(&mut draw, scenario);
        let duration_s = rows as f64 / rate_hz;
        let mut claim =
            Claim { rate_hz, bias_deg_h: rounded(draw.uniform(-12.0, 12.0), 4), ..Claim::default() };
        noise(&mut draw, &mut claim, duration_s);
        let sigma = claim.white_sigma();
        claim.uncertainty = Uncertainty {
            n_rel: rounded(draw.uniform(0.008, 0.03), 2),
            b_rel: rounded(draw.uniform(0.08, 0.15), 2),
            k_rel: rounded(draw.uniform(0.1, 0.2), 2),
            bias_deg_h: rounded(sigma.min(3.0) * draw.log_uniform(0.01, 0.3), 2),
            ..Uncertainty::default()
        };
        let time_s: Vec<f64> = (0..rows).map(|i| i as f64 / rate_hz).collect();
        let mut drivers = drive(&mut draw, scenario, duration_s, rate_hz);
        claim.description = drivers.description.to_string();
        if drivers.thermal.is_some() {
            let reference = rounded(draw.uniform(15.0, 25.0), 2);
            let coefficient = rounded(draw.sign() * draw.log_uniform(0.002, 0.2) * sigma, 3);
            claim.temperature = Some((coefficient, reference));
            claim.uncertainty.coefficient = rounded(coefficient.abs() * draw.uniform(0.005, 0.05), 2);
        }
        if drivers.table.is_some() {
            claim.scale_ppm = Some(rounded(draw.uniform(-50.0, 50.0), 3));
            claim.uncertainty.scale_ppm = rounded(draw.log_uniform(0.3, 5.0), 2);
        }
        if drivers.heading.is_some() && drivers.table.is_none() {
            let latitude = rounded(draw.uniform(20.0, 65.0), 4);
            claim.earth = Some((latitude, rounded(draw.uniform(0.0, 360.0), 4)));
        }
        drivers.decoys(&mut draw, duration_s, scenario);
        claim.columns = drivers.columns();
        let departure = Departure::drawn(&mut draw, &claim.uncertainty);
        Setting { scenario, rows, claim, departure, time_s, drivers }
    }

    /// Length of the record, s.
    pub fn duration_s(&self) -> f64 {
        self.rows as f64 / self.claim.rate_hz
    }

    /// Sampling interval, s.
    pub fn interval_s(&self) -> f64 {
        1.0 / self.claim.rate_hz
    }

    /// What the claim foresees with the true nuisances, for a gyro that lives `late_s(t)` behind its references, deg/h.
    pub fn known(&self, late_s: impl Fn(f64) -> f64) -> Vec<f64> {
        let (c, d) = (&self.claim, &self.departure);
        let width = self.interval_s();
        self.time_s
            .iter()
            .map(|&at| {
                let t = at - late_s(at);
                let mut y = c.bias_deg_h + d.bias_deg_h;
                if let (Some((coefficient, reference)), Some(thermal)) =
                    (c.temperature, &self.drivers.thermal)
                {
                    y += (coefficient + d.coefficient) * (thermal.at(t) - reference);
                }
                if let (Some(ppm), Some(table)) = (c.scale_ppm, &self.drivers.table) {
                    y += 3600.0 * (1.0 + 1e-6 * (ppm + d.scale_ppm)) * table.mean(t, width);
                }
                if let Some((latitude, azimuth)) = c.earth {
                    let heading = self.drivers.heading_deg(t) + azimuth;
                    y += EARTH_DEG_H * latitude.to_radians().cos() * heading.to_radians().cos();
                }
                y
            })
            .collect()
    }

    /// Columns whose factors may move within a prior, each with its standard deviation.
    pub fn free_columns(&self) -> Vec<(Vec<f64>, f64)> {
        let width = self.interval_s();
        let mut out = Vec::new();
        if let (Some((_, reference)), Some(thermal)) = (self.claim.temperature, &self.drivers.thermal) {
            let column = self.time_s.iter().map(|&t| thermal.at(t) - reference).collect();
            out.push((column, self.claim.uncertainty.coefficient));
        }
        if let (Some(_), Some(table)) = (self.claim.scale_ppm, &self.drivers.table) {
            let column = self.time_s.iter().map(|&t| 3.6e-3 * table.mean(t, width)).collect();
            out.push((column, self.claim.uncertainty.scale_ppm));
        }
        out
    }
}
