//! Static responses with a dead zone.

use crate::estimate::normal_probability;
use std::sync::LazyLock;

/// Standard deviations beyond which noise rounds nothing off.
const MAX_ROUNDED_DEVIATIONS: f64 = 8.0;

/// Kind of a dead zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The output is short by the half width.
    Subtractive,
    /// The output is none inside and whole outside.
    Gap,
    /// The output is none inside and the root of x² − δ² outside: two beams that are locked to one another.
    Locked,
    /// Subtractive, with noise inside the loop that carries the input in and out of the zone.
    Rounded,
}

impl Kind {
    /// The kinds without noise inside the loop.
    pub const NOISE_FREE: [Kind; 3] = [Kind::Subtractive, Kind::Gap, Kind::Locked];

    /// The input at which half comes through, in half widths; of the kinds without noise.
    pub fn threshold_over_width(self) -> f64 {
        match self {
            Kind::Gap => 1.0,
            Kind::Locked => 2.0 / 3f64.sqrt(),
            Kind::Subtractive | Kind::Rounded => 2.0,
        }
    }
}

/// A dead zone about zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Its kind.
    pub kind: Kind,
    /// Half width, deg/h.
    pub half_width: f64,
    /// Standard deviation of the noise inside the loop, deg/h; 0 of the kinds without.
    pub noise: f64,
}

impl Shape {
    /// A zone without noise inside the loop.
    pub fn clean(kind: Kind, half_width: f64) -> Shape {
        Shape { kind, half_width, noise: 0.0 }
    }

    /// Mean output at an input.
    pub fn of(&self, x: f64) -> f64 {
        let delta = self.half_width;
        match self.kind {
            Kind::Subtractive => x.signum() * (x.abs() - delta).max(0.0),
            Kind::Gap => {
                if x.abs() > delta {
                    x
                } else {
                    0.0
                }
            }
            Kind::Locked => x.signum() * (x * x - delta * delta).max(0.0).sqrt(),
            Kind::Rounded => {
                let part = |u: f64| self.noise * beyond(u / self.noise);
                part(x - delta) - part(-x - delta)
            }
        }
    }

    /// Share of the smallest inputs that comes through.
    pub fn at_null(&self) -> f64 {
        match self.kind {
            Kind::Rounded => 2.0 * normal_probability(-self.half_width / self.noise),
            _ if self.half_width > 0.0 => 0.0,
            _ => 1.0,
        }
    }

    /// The input at which half comes through; 0 where half of any does.
    pub fn threshold(&self) -> f64 {
        match self.kind {
            Kind::Subtractive | Kind::Gap | Kind::Locked => {
                self.kind.threshold_over_width() * self.half_width
            }
            Kind::Rounded => {
                // The share that comes through grows with the input, and is a half at twice the half width at the latest.
                let (mut low, mut high) = (0.0, 2.0 * self.half_width);
                if self.at_null() >= 0.5 {
                    return 0.0;
                }
                for _ in 0..50 {
                    let middle = 0.5 * (low + high);
                    if self.of(middle) < 0.5 * middle { low = middle } else { high = middle }
                }
                0.5 * (low + high)
            }
        }
    }
}

/// Nodes per unit between which [`beyond`] is a cubic: within 1e-10.
const NODES_PER_UNIT: f64 = 64.0;

/// Mean of what a normal value about `u` of unit variance has above zero. A fit asks for it millions of times: it is
/// interpolated between nodes of value and slope.
fn beyond(u: f64) -> f64 {
    if u.is_nan() || u.abs() >= MAX_ROUNDED_DEVIATIONS {
        return u.max(0.0);
    }
    static AT_NODES: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
        let count = (2.0 * MAX_ROUNDED_DEVIATIONS * NODES_PER_UNIT) as usize;
        (0..=count).map(|i| exact_beyond(i as f64 / NODES_PER_UNIT - MAX_ROUNDED_DEVIATIONS)).collect()
    });
    let place = (u + MAX_ROUNDED_DEVIATIONS) * NODES_PER_UNIT;
    let i = place as usize;
    let (Some((f0, d0)), Some((f1, d1))) = (AT_NODES.get(i), AT_NODES.get(i + 1)) else { return u.max(0.0) };
    let (t, step) = (place - i as f64, 1.0 / NODES_PER_UNIT);
    let rise = f1 - f0;
    f0 + t * (step * d0 + t * (3.0 * rise - step * (2.0 * d0 + d1) + t * (step * (d0 + d1) - 2.0 * rise)))
}

/// The same in its closed form, and its slope.
fn exact_beyond(u: f64) -> (f64, f64) {
    let slope = normal_probability(u);
    (u * slope + (-0.5 * u * u).exp() / std::f64::consts::TAU.sqrt(), slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(half_width: f64, noise: f64) -> Shape {
        Shape { kind: Kind::Rounded, half_width, noise }
    }

    #[test]
    fn a_rounded_zone_is_the_mean_over_the_noise_by_quadrature() {
        let (delta, sigma) = (0.12, 0.07);
        for x in [-0.5, -0.1, 0.0, 0.03, 0.12, 0.3] {
            let clean = Shape::clean(Kind::Subtractive, delta);
            let (mut sum, mut weights) = (0.0, 0.0);
            for i in -8000..=8000 {
                let z = f64::from(i) * 1e-3;
                let w = (-0.5 * z * z).exp();
                sum += w * clean.of(x + sigma * z);
                weights += w;
            }
            assert!((rounded(delta, sigma).of(x) - sum / weights).abs() < 1e-6, "{x}");
        }
    }

    #[test]
    fn a_rounded_zone_has_the_slope_at_null_and_the_offset_of_the_closed_form() {
        let slope = |delta: f64, sigma: f64| rounded(delta, sigma).of(1e-6) / 1e-6;
        assert!((slope(1.0, 3.0) - 2.0 * normal_probability(-1.0 / 3.0)).abs() < 1e-6);
        assert!((slope(1.0, 0.8) - rounded(1.0, 0.8).at_null()).abs() < 1e-6);
        assert!((rounded(0.2, 0.1).of(5.0) - 4.8).abs() < 1e-12);
        assert!((rounded(0.2, 1e-9).of(0.3) - 0.1).abs() < 1e-9);
    }

    #[test]
    fn what_is_interpolated_is_the_closed_form() {
        for i in -9000..=9000 {
            let u = 1e-3 * f64::from(i) + 3e-4;
            let exact = if u.abs() < MAX_ROUNDED_DEVIATIONS { exact_beyond(u).0 } else { u.max(0.0) };
            assert!((beyond(u) - exact).abs() < 2e-10, "{u}");
        }
        assert!(beyond(-8.0) == 0.0 && beyond(8.0) == 8.0);
    }

    #[test]
    fn half_comes_through_at_the_threshold() {
        let zone = rounded(0.2, 0.1);
        let t = zone.threshold();
        assert!((zone.of(t) - 0.5 * t).abs() < 1e-9 && t > 0.2 && t < 0.4, "{t}");
        assert_eq!(rounded(0.1, 0.2).threshold(), 0.0);
        assert_eq!(Shape::clean(Kind::Subtractive, 0.1).threshold(), 0.2);
        for kind in Kind::NOISE_FREE {
            let zone = Shape::clean(kind, 0.3);
            let t = zone.threshold();
            assert!(zone.of(0.999 * t) < 0.4995 * t && zone.of(1.001 * t) > 0.5 * t, "{kind:?}");
            assert_eq!(zone.of(0.2), 0.0);
        }
    }
}
