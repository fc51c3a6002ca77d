//! Steps of the clock of a device against that of this computer.
//!
//! What a device says arrives late by a delay that varies and is never negative, so the device seems slow by it. Its least in a
//! short window is that of the link. A step moves the least, a burst of late lines does not.

use crate::clock::seconds;

/// Length of a window, s.
const WINDOW_S: f64 = 2.0;

/// Watches the clock of a device.
#[derive(Debug)]
pub(crate) struct ClockSteps {
    /// Smallest change that is a step, s.
    least_s: f64,
    /// Beginning of the present window, s, and the greatest difference in it.
    window: Option<(f64, f64)>,
    /// The greatest difference in the window before.
    before: Option<f64>,
}

impl ClockSteps {
    /// Watches for steps of at least `least_s`.
    pub fn new(least_s: f64) -> ClockSteps {
        ClockSteps { least_s, window: None, before: None }
    }

    /// Takes a line; gives the size of a step, s, positive where the clock of the device was put forward.
    pub fn take(&mut self, at_ns: i64, device_s: f64) -> Option<f64> {
        let at_s = seconds(at_ns);
        let ahead = device_s - at_s;
        let (began, greatest) = match self.window {
            Some((began, greatest)) if at_s - began < WINDOW_S => {
                self.window = Some((began, greatest.max(ahead)));
                return None;
            }
            Some(window) => window,
            None => {
                self.window = Some((at_s, ahead));
                return None;
            }
        };
        self.window = Some((at_s, ahead));
        let step = self.before.map(|before| greatest - before);
        self.before = Some(greatest);
        // Windows far apart say nothing: the clocks drift meanwhile.
        step.filter(|step| step.abs() >= self.least_s && at_s - began < 10.0 * WINDOW_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(step_s: f64, delay_s: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut steps = ClockSteps::new(0.5);
        let mut found = vec![];
        for i in 0..600 {
            let true_s = i as f64 * 0.1;
            let device_s = 1e6 + true_s * 1.000_02 + if i >= 300 { step_s } else { 0.0 };
            found.extend(steps.take(((true_s + delay_s(i)) * 1e9) as i64, device_s));
        }
        found
    }

    #[test]
    fn a_step_is_found_once_with_its_sign_and_its_size() {
        for size in [3.0, -3.0, 0.7] {
            let [found] = run(size, |i| 0.001 * (i % 7) as f64)[..] else { panic!("{size}") };
            assert!((found - size).abs() < 0.02, "{size}: {found}");
        }
    }

    #[test]
    fn drift_and_lines_that_arrive_in_bursts_are_no_step() {
        assert_eq!(run(0.0, |_| 0.0), Vec::<f64>::new());
        // Ten lines at once, the first of them a second late.
        assert_eq!(run(0.0, |i| 0.1 * (9 - i % 10) as f64), Vec::<f64>::new());
    }
}
