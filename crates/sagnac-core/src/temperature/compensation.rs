//! The model as a table that a system can compensate by: TOML, JSON and a C header.
//!
//! The bias is `bias_deg_h(T) + rate · dT/dt`, T the temperature of the sensor behind a first-order lag of the stated
//! time constant. Hysteresis cannot be compensated from a temperature alone and is stated beside.

use super::findings::Analysis;
use crate::c_header::CHeader;
use serde::Serialize;

/// Points of the table.
const TABLE_POINTS: usize = 25;

/// A compensation table: the bias of a gyro over temperature, as numbers that firmware can use.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compensation {
    /// Version of the format.
    pub format: &'static str,
    /// Channel.
    pub channel: String,
    /// Serial number of the unit.
    pub serial: Option<String>,
    /// Range in which the table was measured, degC; beyond it nothing is known.
    pub valid_deg_c: [f64; 2],
    /// Coefficients of the static bias in powers of x = (T − middle)/half, deg/h, the constant first. The constant holds
    /// the Earth rate that the recording held.
    pub polynomial_deg_h: Vec<f64>,
    /// Middle of the range, degC.
    pub middle_deg_c: f64,
    /// Half of the range, degC.
    pub half_deg_c: f64,
    /// Sensitivity to the rate of temperature, deg/h per degC/min; 0 where it was not told apart.
    pub rate_deg_h_per_deg_c_min: f64,
    /// Time constant by which the temperature of the sensor is to be delayed, s; 0 where it was not told apart.
    pub lag_s: f64,
    /// Half of the gap of the hysteresis, deg/h: what no temperature compensates.
    pub hysteresis_deg_h: f64,
    /// Rms of the bias that the table leaves, deg/h.
    pub residual_rms_deg_h: f64,
    /// Temperatures of the table, degC.
    pub temperature_deg_c: Vec<f64>,
    /// Static bias at them, deg/h.
    pub bias_deg_h: Vec<f64>,
}

impl Compensation {
    /// The compensation table of a fitted model.
    pub fn of(a: &Analysis, channel: &str, serial: Option<&str>) -> Compensation {
        let p = &a.posterior;
        let c = &p.best.fitted.solved.coefficients;
        let separable = a.separable(|s| s.rate.max(s.lag));
        let of = |at: Option<usize>| at.and_then(|i| c.get(i)).copied().unwrap_or(0.0);
        let temperature_deg_c: Vec<f64> = (0..TABLE_POINTS)
            .map(|i| p.span.temperature(2.0 * i as f64 / (TABLE_POINTS - 1) as f64 - 1.0))
            .collect();
        let mut polynomial = powers(c.as_slice().get(..a.order).unwrap_or_default());
        polynomial[0] += a.level_deg_h;
        Compensation {
            format: "compensation/1",
            channel: channel.to_owned(),
            serial: serial.map(str::to_owned),
            valid_deg_c: [p.span.low, p.span.high],
            polynomial_deg_h: polynomial,
            middle_deg_c: 0.5 * (p.span.low + p.span.high),
            half_deg_c: 0.5 * (p.span.high - p.span.low),
            rate_deg_h_per_deg_c_min: if separable { of(p.terms.rate_at()) } else { 0.0 },
            lag_s: if separable { p.best.shape.lag_s } else { 0.0 },
            hysteresis_deg_h: of(p.terms.hysteresis_at()),
            residual_rms_deg_h: a.residual_rms,
            bias_deg_h: temperature_deg_c.iter().map(|t| a.bias_at(*t)).collect(),
            temperature_deg_c,
        }
    }

    /// The table as the text of a C header.
    pub fn header(&self) -> String {
        let mut out = CHeader::new("COMPENSATION", &self.channel);
        out.define("VALID_LOW_DEGC", self.valid_deg_c[0]);
        out.define("VALID_HIGH_DEGC", self.valid_deg_c[1]);
        out.define("MIDDLE_DEGC", self.middle_deg_c);
        out.define("HALF_DEGC", self.half_deg_c);
        out.define("RATE_DEGH_PER_DEGC_MIN", self.rate_deg_h_per_deg_c_min);
        out.define("LAG_S", self.lag_s);
        out.define("HYSTERESIS_DEGH", self.hysteresis_deg_h);
        out.count("ORDER", self.polynomial_deg_h.len().saturating_sub(1));
        out.count("POINTS", self.temperature_deg_c.len());
        out.gap();
        out.array("POLYNOMIAL_DEGH", &self.polynomial_deg_h);
        out.array("TEMPERATURE_DEGC", &self.temperature_deg_c);
        out.array("BIAS_DEGH", &self.bias_deg_h);
        out.finish()
    }
}

/// Legendre coefficients 1, 2, ... as coefficients of powers 0, 1, 2, ...
fn powers(legendre: &[f64]) -> Vec<f64> {
    let n = legendre.len();
    let mut out = vec![0.0; n + 1];
    let (mut before, mut here) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    before[0] = 1.0;
    if n > 0 {
        here[1] = 1.0;
    }
    for (i, c) in legendre.iter().enumerate() {
        out.iter_mut().zip(&here).for_each(|(o, h)| *o += c * h);
        let k = (i + 1) as f64;
        let mut next = vec![0.0; n + 1];
        for j in 0..=n {
            let raised = if j > 0 { here[j - 1] } else { 0.0 };
            next[j] = ((2.0 * k + 1.0) * raised - k * before[j]) / (k + 1.0);
        }
        (before, here) = (here, next);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temperature::course::legendre;

    #[test]
    fn powers_give_the_same_curve() {
        let c = [0.3, -0.7, 0.11, 0.05, -0.2];
        let p = powers(&c);
        for x in [-1.0, -0.4, 0.0, 0.9f64] {
            let direct: f64 = legendre(x, 5).iter().zip(c).map(|(b, c)| b * c).sum();
            let by_powers: f64 = p.iter().rev().fold(0.0, |s, a| s * x + a);
            assert!((direct - by_powers).abs() < 1e-12);
        }
    }
}
