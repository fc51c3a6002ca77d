//! Simulated samples through a low-pass filter.

use super::shape::{SIDE, filtered, taps_of};
use crate::effect::LowPass;

/// A filter at work.
pub(super) struct Filtering {
    filter: LowPass,
    /// Taps that correct the response of the recursion to the wanted one.
    taps: Option<[f64; SIDE + 1]>,
    /// The last two samples that came in, and that went out, the latest first.
    before: Option<([f64; 2], [f64; 2])>,
    /// What the next block of the correction begins with.
    ahead: Vec<f64>,
}

impl Filtering {
    pub fn new(filter: LowPass) -> Filtering {
        let taps = filter.correction(0.0).map(|_| taps_of(|x| filter.correction(x).unwrap_or(1.0)));
        Filtering { filter, taps, before: None, ahead: vec![] }
    }

    /// Samples that must come in before the first that goes out.
    pub fn lead(&self) -> usize {
        self.filter.memory + if self.taps.is_some() { 2 * SIDE } else { 0 }
    }

    fn recursed(&mut self, values: &mut [f64]) {
        let first = values.first().copied().unwrap_or(0.0);
        // It begins at rest, at the level of the first sample.
        let (mut x, mut y) = self.before.unwrap_or(([first; 2], [first; 2]));
        let (b, a) = (self.filter.forward, self.filter.back);
        for value in values {
            let out = b[0] * *value + b[1] * x[0] + b[2] * x[1] - a[0] * y[0] - a[1] * y[1];
            (x, y) = ([*value, x[0]], [out, y[0]]);
            *value = out;
        }
        self.before = Some((x, y));
    }

    /// Takes in what leads.
    pub fn begin(&mut self, mut values: Vec<f64>) {
        self.recursed(&mut values);
        let kept = if self.taps.is_some() { 2 * SIDE } else { 0 };
        self.ahead = values.split_off(values.len().saturating_sub(kept));
    }

    /// The next samples.
    pub fn through(&mut self, mut values: Vec<f64>) -> Vec<f64> {
        self.recursed(&mut values);
        let Some(taps) = &self.taps else { return values };
        let samples = values.len();
        let mut all = std::mem::take(&mut self.ahead);
        all.append(&mut values);
        let mut out = vec![0.0; samples];
        filtered(&all, taps, &mut out);
        self.ahead = all.split_off(samples);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_passes_unchanged_and_blocks_do_not_show() {
        let mut whole = Filtering::new(LowPass::smoothing(0.05));
        let mut parts = Filtering::new(LowPass::smoothing(0.05));
        let values: Vec<f64> = (0..200).map(|i| 7.0 + f64::from(i * 37 % 11)).collect();
        let at_once = whole.through(values.clone());
        let pieces = [parts.through(values[..33].to_vec()), parts.through(values[33..].to_vec())].concat();
        assert_eq!(at_once, pieces);
        let mut level = Filtering::new(LowPass::butterworth(0.1));
        assert!(level.through(vec![3.0; 50]).iter().all(|y| (y - 3.0).abs() < 1e-12));
    }
}
