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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_less_than_a_step_stays_for_the_next_sample() {
        // 0.4 arcsec each 0.5 s: 0.8 deg/h, counted in steps of 1 arcsec, which are 2 deg/h.
        let mut counter = Counter::new(1.0, 0.5).unwrap();
        let mut rate = vec![0.8; 5];
        counter.count(&mut rate);
        // Angles 0.4, 0.8, 1.2, 1.6, 2.0 are 0, 1, 1, 2, 2 steps.
        assert_eq!(rate, [0.0, 2.0, 0.0, 2.0, 0.0]);
        assert!(Counter::new(0.0, 1.0).is_none());
    }
}
