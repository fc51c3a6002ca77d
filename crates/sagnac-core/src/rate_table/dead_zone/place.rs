//! Where a dead zone may lie.
//!
//! A unit's zone lies where its loop is at rest: where the input is none, about which the rates of a test are set, or,
//! with a bias in front of the zone, where the output is none. Neither need be so: an input axis that stands off, or a
//! bias that is divided, puts it elsewhere. Each of the three is given the same share.

/// Standard deviation of what a place is known to, in distances of neighbouring rates.
const OF_SPACING: f64 = 0.25;

/// Density of the centre of a zone over the rates.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Middle of the rates and the rate at which the output is none, deg/h.
    pub at_rest: [f64; 2],
    /// Uncertainties of these two, deg/h.
    pub standard: f64,
    /// Half of the rates that the centre is sought in, deg/h.
    pub half: f64,
}

impl Place {
    /// `middle` of the rates and `half` the range of what is searched, with the noise of a mean, the distance of
    /// neighbouring rates and that of the centres tried.
    pub fn new(middle: f64, half: f64, output_null: f64, noise: f64, apart: f64, tried: f64) -> Place {
        Place { at_rest: [middle, output_null], standard: (OF_SPACING * apart).hypot(noise).max(tried), half }
    }

    /// Density at a centre, 1/(deg/h).
    pub fn density(&self, centre: f64) -> f64 {
        let normal = |at: f64| {
            let z = (centre - at) / self.standard;
            (-0.5 * z * z).exp() / (self.standard * std::f64::consts::TAU.sqrt())
        };
        let [input, output] = self.at_rest;
        (normal(input) + normal(output) + 0.5 / self.half) / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_places_together_are_certain() {
        let place = Place::new(-12.0, 0.6, -12.1, 0.01, 0.1, 0.02);
        let step = 1e-4;
        let sum: f64 = (-6000..=6000).map(|i| place.density(-12.0 + step * f64::from(i)) * step).sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        assert!(place.density(-12.0) > 4.0 * place.density(-11.5));
    }
}
