//! Uncertainty of the mean rate over a record, and the Earth rate that is taken out of it.
//!
//! Source: GUM (JCGM 100) for the combination; the variance of a mean of correlated noise from its spectrum. Not
//! σ/√n: neighbouring samples of flicker and random walk are not independent.

use super::composite::Composite;
use crate::numeric::special::cosine_integral;
use std::f64::consts::PI;

/// Rotation rate of the Earth, deg/h (7.292115e-5 rad/s).
pub use crate::units::EARTH_RATE_DEG_H;

/// Contributions to the squared standard uncertainty of a mean rate, (deg/h)².
#[derive(Debug, Clone, PartialEq)]
pub struct BiasUncertainty {
    /// N²/T.
    pub angle_random_walk: f64,
    /// Flicker above `lowest_hz`.
    pub flicker: f64,
    /// K²T/3, about the bias at the start of the record.
    pub rate_random_walk: f64,
    /// (R T)²/12: how far a ramp spreads the bias over the record.
    pub rate_ramp: f64,
    /// 2Q²/T².
    pub quantization: f64,
    /// Variance of the mean of Markov processes and quasi-periodic disturbances.
    pub correlated: f64,
    /// Contributions from elsewhere, by name: Earth rate, temperature, table.
    pub others: Vec<(&'static str, f64)>,
    /// Lowest frequency that flicker was counted from, Hz. The mean of flicker is not stationary: it must be stated.
    pub lowest_hz: f64,
}

impl BiasUncertainty {
    /// The uncertainty of the mean over `length_s`.
    ///
    /// `noise` should hold every term the record allows, claimed or not ([`super::identification::Identification::allowed`]),
    /// so that flicker too weak to be claimed is not ignored. `lowest_hz` defaults to 1/(2πT). `others` are standard
    /// uncertainties in deg/h.
    pub fn of_mean(
        noise: &Composite,
        length_s: f64,
        lowest_hz: Option<f64>,
        others: &[(&'static str, f64)],
    ) -> BiasUncertainty {
        let model = &noise.terms;
        let correlated = noise.markov.iter().chain(&noise.quasi_periodic);
        let length_h = length_s / 3600.0;
        let lowest_hz = lowest_hz.filter(|f| *f > 0.0).unwrap_or(1.0 / (2.0 * PI * length_s));
        BiasUncertainty {
            angle_random_walk: model.n * model.n / length_h,
            flicker: model.b * model.b / PI * flicker_bracket(2.0 * PI * lowest_hz * length_s),
            rate_random_walk: model.k * model.k * length_h / 3.0,
            rate_ramp: (model.r * length_h).powi(2) / 12.0,
            quantization: 2.0 * (model.q / length_s).powi(2),
            correlated: correlated.map(|d| d.mean_variance(length_s)).sum(),
            others: others.iter().map(|(name, u)| (*name, u * u)).collect(),
            lowest_hz,
        }
    }

    /// Squared standard uncertainty, (deg/h)².
    pub fn variance(&self) -> f64 {
        self.angle_random_walk
            + self.flicker
            + self.rate_random_walk
            + self.rate_ramp
            + self.quantization
            + self.correlated
            + self.others.iter().map(|(_, v)| v).sum::<f64>()
    }

    /// Standard uncertainty, deg/h.
    pub fn standard(&self) -> f64 {
        self.variance().sqrt()
    }
}

/// The variance of a mean of 1/f noise above a lowest frequency, in units of B²/π: (1 − cos b)/b² + sin b/b − Ci(b)
/// with b = 2π f_L T.
pub fn flicker_bracket(b: f64) -> f64 {
    if b <= 0.0 {
        return f64::INFINITY;
    }
    let half = (0.5 * b).sin();
    (2.0 * half * half / (b * b) + b.sin() / b - cosine_integral(b)).max(0.0)
}

/// A quantity with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// Value.
    pub value: f64,
    /// Standard uncertainty, same unit.
    pub uncertainty: f64,
}

/// Where the input axis points. All angles in degrees; they become radians inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// Geographic latitude, deg, north positive.
    pub latitude_deg: Uncertain,
    /// Heading of the axis from north, deg, positive towards east.
    pub heading_deg: Uncertain,
    /// Elevation of the axis above the horizontal, deg: 90 is up.
    pub elevation_deg: Uncertain,
}

/// The Earth rate on the input axis with its standard uncertainty, deg/h.
///
/// Ω = Ω_E (cos φ cos E cos A + sin φ sin E); the three angles are taken as independent. The second-order part of
/// the expansion is kept as well, so that an axis at a stationary point does not come out as exactly known.
pub fn earth_rate(orientation: &Orientation) -> Uncertain {
    let rad = |u: Uncertain| (u.value.to_radians(), u.uncertainty.to_radians());
    let ((phi, u_phi), (a, u_a), (e, u_e)) =
        (rad(orientation.latitude_deg), rad(orientation.heading_deg), rad(orientation.elevation_deg));
    let horizontal = phi.cos() * e.cos() * a.cos();
    let vertical = phi.sin() * e.sin();
    let first = [
        (-phi.sin() * e.cos() * a.cos() + phi.cos() * e.sin()) * u_phi,
        phi.cos() * e.cos() * a.sin() * u_a,
        (-phi.cos() * e.sin() * a.cos() + phi.sin() * e.cos()) * u_e,
    ];
    let second = [
        (horizontal + vertical) * u_phi * u_phi,
        horizontal * u_a * u_a,
        (horizontal + vertical) * u_e * u_e,
    ];
    let square: f64 =
        first.iter().map(|d| d * d).sum::<f64>() + second.iter().map(|d| 0.5 * d * d).sum::<f64>();
    Uncertain {
        value: EARTH_RATE_DEG_H * (horizontal + vertical),
        uncertainty: EARTH_RATE_DEG_H * square.sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::model::NoiseModel;
    use crate::noise::simulate::{Setup, Simulator};

    fn exact(value: f64) -> Uncertain {
        Uncertain { value, uncertainty: 0.0 }
    }

    #[test]
    fn earth_rate_at_56_degrees_agrees_with_published_numbers() {
        let at = |heading, elevation| Orientation {
            latitude_deg: exact(56.0),
            heading_deg: exact(heading),
            elevation_deg: exact(elevation),
        };
        assert!((EARTH_RATE_DEG_H - 15.0411).abs() < 5e-5);
        assert!((earth_rate(&at(0.0, 90.0)).value - 12.47).abs() < 5e-3);
        assert!((earth_rate(&at(0.0, 0.0)).value - 8.41).abs() < 5e-3);
        assert!(earth_rate(&at(90.0, 0.0)).value.abs() < 1e-12);
        let arcsec = 1.0 / 3600.0;
        let mut tilted = at(0.0, 90.0);
        tilted.elevation_deg.uncertainty = arcsec;
        assert!((earth_rate(&tilted).uncertainty - 4.1e-5).abs() < 1e-6);
        let mut east = at(90.0, 0.0);
        east.heading_deg.uncertainty = 60.0 * arcsec;
        assert!((earth_rate(&east).uncertainty - 2.4e-3).abs() < 5e-5);
    }

    #[test]
    fn flicker_bracket_agrees_with_its_asymptote_and_an_integral() {
        let asymptote = |b: f64| (1.0 / b).ln() + 1.5 - 0.577_215_664_901_532_9;
        assert!((flicker_bracket(0.02) / asymptote(0.02) - 1.0).abs() < 1e-5);
        assert!((asymptote(1.0) / flicker_bracket(1.0) - 0.96).abs() < 0.01);
        // ∫_b^∞ (sin(u/2)/(u/2))² du/u, summed.
        let (b, mut sum, step): (f64, f64, f64) = (1.0, 0.0, 1e-3);
        for i in 0..400_000 {
            let u: f64 = b + (f64::from(i) + 0.5) * step;
            sum += (2.0 * (0.5 * u).sin() / u).powi(2) / u * step;
        }
        assert!((sum - flicker_bracket(b)).abs() < 1e-4, "{sum} {}", flicker_bracket(b));
    }

    #[test]
    fn mean_scatters_as_stated() {
        // White noise and a walk about the starting bias: the mean of each record against the stated uncertainty.
        let model = NoiseModel { n: 0.002, k: 0.0008, q: 0.05, ..Default::default() };
        let (samples, tau0_s) = (600, 10.0);
        let stated =
            BiasUncertainty::of_mean(&model.into(), samples as f64 * tau0_s, None, &[("table", 0.0)])
                .variance();
        let runs = 400;
        let mut square = 0.0;
        let mut inside = 0;
        for run in 0..runs {
            let setup = Setup { bias_deg_h: 1.23, ..Setup::for_record(run, tau0_s, samples as u64) };
            let mean =
                Simulator::new(&model, &setup).take(samples).iter().sum::<f64>() / samples as f64 - 1.23;
            square += mean * mean / runs as f64;
            inside += usize::from(mean.abs() < 1.96 * stated.sqrt());
        }
        // Four standard deviations of a mean square, and of a share.
        let deviation = |variance: f64| (variance / runs as f64).sqrt();
        assert!((square / stated - 1.0).abs() < 4.0 * deviation(2.0), "{}", square / stated);
        let coverage = inside as f64 / runs as f64;
        assert!((coverage - 0.95).abs() < 4.0 * deviation(0.95 * 0.05), "{coverage}");
    }

    #[test]
    fn mean_of_flicker_scatters_as_stated_between_two_lengths() {
        // The difference of the means over a record and over its first sixteenth does not depend on the lowest
        // frequency: V(t) − V(T) of the model against the difference of two brackets.
        let model = NoiseModel { b: 0.01, ..Default::default() };
        let u2 = |t| BiasUncertainty::of_mean(&model.into(), t, Some(1e-9), &[]).flicker;
        let from_model = model.mean_variance(1000.0) - model.mean_variance(16000.0);
        assert!(((u2(1000.0) - u2(16000.0)) / from_model - 1.0).abs() < 1e-3);
    }
}
