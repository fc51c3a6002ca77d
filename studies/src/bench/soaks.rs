//! Rates of a table repeated at temperatures of a chamber, from rates that are known exactly. Imports nothing of the program under test.

use super::noise_source::NoiseSource;
use serde::Deserialize;

/// Samples a second.
const HZ: f64 = 1.0;
/// Scatter of the thermometer, degC.
const READING_DEG_C: f64 = 0.02;
/// Distance between temperatures from which they are two, degC.
const SAME_DEG_C: f64 = 1.0;

/// A unit on a table in a chamber, and the schedule of both.
#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Soaks {
    /// Temperatures of the soaks in order of time, degC.
    pub temperatures: Vec<f64>,
    /// Rates of a cycle, deg/s.
    pub rates: Vec<f64>,
    /// Cycles at each soak.
    pub cycles: usize,
    /// Time at a rate, s.
    pub dwell_s: f64,
    /// Time from one soak to the next, the table at rest, s.
    pub ramp_s: f64,
    /// Deviation of the scale factor at the middle of the temperatures, ppm.
    pub error_ppm: f64,
    /// Its change with temperature, ppm/degC.
    pub per_degree_ppm: f64,
    /// What a parabola adds to it at both ends of the temperatures, ppm.
    pub parabola_ppm: f64,
    /// Difference between heating and cooling, ppm.
    pub hysteresis_ppm: f64,
    /// Standard deviation between cycles, ppm.
    pub cycle_ppm: f64,
    /// Cubic error at the largest rate, ppm of that rate.
    pub odd_ppm: f64,
    /// deg/h
    pub bias: f64,
    /// Change of the bias with temperature, deg/h/degC.
    pub bias_per_degree: f64,
    /// N, deg/√h.
    pub n: f64,
    /// B of 1/f noise, deg/h.
    pub b: f64,
    /// Seed of the noise.
    #[serde(skip)]
    pub seed: u64,
}

impl Default for Soaks {
    fn default() -> Soaks {
        Soaks {
            temperatures: vec![-40.0, 0.0, 35.0, 70.0, 35.0, 0.0, -40.0],
            rates: vec![0.0, 40.0, -40.0, 100.0, -100.0],
            cycles: 2,
            dwell_s: 20.0,
            ramp_s: 300.0,
            error_ppm: 0.0,
            per_degree_ppm: 0.0,
            parabola_ppm: 0.0,
            hysteresis_ppm: 0.0,
            cycle_ppm: 0.0,
            odd_ppm: 0.0,
            bias: 2.0,
            bias_per_degree: 0.0,
            n: 0.004,
            b: 0.0,
            seed: 0,
        }
    }
}

impl Soaks {
    fn ends(&self) -> (f64, f64) {
        self.temperatures.iter().fold((f64::MAX, f64::MIN), |(l, h), t| (l.min(*t), h.max(*t)))
    }

    /// +1 of a soak that was reached from below, −1 from above, 0 of the first.
    fn direction(&self, soak: usize) -> f64 {
        match soak.checked_sub(1) {
            Some(before) => (self.temperatures[soak] - self.temperatures[before]).signum(),
            None => 0.0,
        }
    }

    /// Deviation of the scale factor at a soak, ppm, without what differs between cycles.
    fn at_soak(&self, soak: usize) -> f64 {
        let ((low, high), t) = (self.ends(), self.temperatures[soak]);
        let off = t - 0.5 * (low + high);
        self.error_ppm
            + self.per_degree_ppm * off
            + self.parabola_ppm * (2.0 * off / (high - low)).powi(2)
            + 0.5 * self.hysteresis_ppm * self.direction(soak)
    }

    /// Temperatures that differ, with the soaks of each.
    fn points(&self) -> Vec<(f64, Vec<usize>)> {
        let mut points: Vec<(f64, Vec<usize>)> = vec![];
        for (soak, t) in self.temperatures.iter().enumerate() {
            match points.iter_mut().find(|(at, _)| (at - t).abs() < SAME_DEG_C) {
                Some((_, own)) => own.push(soak),
                None => points.push((*t, vec![soak])),
            }
        }
        points
    }

    /// Mean deviation of the scale factor of soaks, ppm; `None` of none.
    fn mean_of(&self, soaks: &[usize]) -> Option<f64> {
        let sum = soaks.iter().map(|s| self.at_soak(*s)).sum::<f64>();
        (!soaks.is_empty()).then(|| sum / soaks.len() as f64)
    }

    /// Largest difference of two temperatures, slope of the line through them and largest difference between both ways: in parts of
    /// the scale factor that the unit has, ppm and ppm/degC.
    pub fn truths(&self) -> [f64; 3] {
        let points: Vec<(f64, f64)> =
            self.points().iter().filter_map(|(t, own)| Some((*t, self.mean_of(own)?))).collect();
        let n = points.len() as f64;
        let (mt, mk) =
            (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
        let square: f64 = points.iter().map(|p| (p.0 - mt).powi(2)).sum();
        let slope = points.iter().map(|p| (p.0 - mt) * (p.1 - mk)).sum::<f64>() / square;
        let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.1), h.max(p.1)));
        let way = |own: &[usize], sign: f64| -> Option<f64> {
            self.mean_of(&own.iter().copied().filter(|s| self.direction(*s) == sign).collect::<Vec<usize>>())
        };
        let gaps =
            self.points().into_iter().filter_map(|(_, own)| Some((way(&own, 1.0)? - way(&own, -1.0)?).abs()));
        let factor = 1.0 + 1e-6 * (mk + self.slope_of_cubic());
        [high - low, slope, gaps.fold(0.0, f64::max)].map(|v| v / factor)
    }

    /// Slope of the line of least squares through the cubic error at the rates that differ, ppm.
    fn slope_of_cubic(&self) -> f64 {
        let mut rates = self.rates.clone();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        let full = rates.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let mean =
            |of: &dyn Fn(f64) -> f64| rates.iter().map(|r| of(r / full)).sum::<f64>() / rates.len() as f64;
        let (x, cube) = (mean(&|u| u), mean(&|u| u.powi(3)));
        self.odd_ppm * (mean(&|u| u.powi(4)) - x * cube) / (mean(&|u| u * u) - x * x)
    }

    /// The recording as it is saved.
    pub fn csv(&self) -> String {
        let mut source = NoiseSource::new(self.seed);
        let full = 3600.0 * self.rates.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let (of_rate, of_ramp) = ((self.dwell_s * HZ) as usize, (self.ramp_s * HZ) as usize);
        // Rate, temperature and deviation of the scale factor of every row.
        let mut rows: Vec<(f64, f64, f64)> = vec![];
        for (soak, temperature) in self.temperatures.iter().enumerate() {
            for _ in 0..self.cycles {
                let gain = self.at_soak(soak) + self.cycle_ppm * source.normal();
                let steps = self.rates.iter().flat_map(|r| (0..of_rate).map(move |_| *r));
                rows.extend(steps.map(|rate| (rate, *temperature, gain)));
            }
            if let Some(next) = self.temperatures.get(soak + 1) {
                let way = |i: usize| temperature + (next - temperature) * (i as f64 + 0.5) / of_ramp as f64;
                rows.extend((0..of_ramp).map(|i| (0.0, way(i), self.at_soak(soak))));
            }
        }
        let white = source.white(self.n, 1.0 / HZ, rows.len());
        let flicker =
            if self.b > 0.0 { source.flicker(self.b, 1.0 / HZ, rows.len()) } else { vec![0.0; rows.len()] };
        let (low, high) = self.ends();
        let middle = 0.5 * (low + high);
        let mut angle = 12.0;
        let mut text = String::from("time_s,rate_deg_h,table_rate_deg_s,table_angle_deg,temp_degC\n");
        for (i, (rate, temperature, gain)) in rows.into_iter().enumerate() {
            let x = 3600.0 * rate;
            let output = x * (1.0 + 1e-6 * gain)
                + 1e-6 * self.odd_ppm * full * (x / full).powi(3)
                + self.bias
                + self.bias_per_degree * (temperature - middle)
                + white[i]
                + flicker[i];
            let read = temperature + READING_DEG_C * source.normal();
            text.push_str(&format!("{},{output:.3},{rate},{angle:.5},{read:.2}\n", i as f64 / HZ));
            angle = (angle + rate / HZ).rem_euclid(360.0);
        }
        text
    }
}
