//! An output that counts angle in whole steps.

/// The counter: what is less than a step stays in it for the next sample.
pub(super) struct Counter {
    step_arcsec: f64,
    dt_s: f64,
    rest_arcsec: f64,
}

impl Counter {
    /// `None` where the output is not quantised.
    pub fn new(step_arcsec: f64, dt_s: f64) -> Option<Counter> {
        (step_arcsec > 0.0).then_some(Counter { step_arcsec, dt_s, rest_arcsec: 0.0 })
    }

    /// The rate, deg/h, that the counted angle shows. 1 arcsec in 1 s is 1 deg/h.
    pub fn count(&mut self, rate: &mut [f64]) {
        for y in rate {
            let angle = self.rest_arcsec + *y * self.dt_s;
            let counts = (angle / self.step_arcsec).round();
            self.rest_arcsec = angle - counts * self.step_arcsec;
            *y = counts * self.step_arcsec / self.dt_s;
        }
    }
}
