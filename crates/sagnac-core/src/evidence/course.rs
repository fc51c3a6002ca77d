//! A gyro and the temperatures recorded with it over the whole recording.

use crate::noise::envelope::Envelope;

/// Means of the rate and of every temperature over spans of equal length, warm-up included.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Course {
    /// The rate, deg/h.
    pub rate: Envelope,
    /// Name and course of each temperature, degC.
    pub temperatures: Vec<(String, Envelope)>,
}

/// Mean temperature and rate of one span.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// degC.
    pub temperature: f64,
    /// deg/h.
    pub rate: f64,
}

impl Course {
    /// The rate beside a temperature in so many parts of the recording, in order of time; empty where their spans differ.
    pub fn beside(&self, temperature: &Envelope, parts: usize) -> Vec<Pair> {
        let rate = &self.rate;
        let aligned = rate.bin_len == temperature.bin_len && rate.first_index == temperature.first_index;
        let both: Vec<Pair> = rate
            .bins
            .iter()
            .zip(&temperature.bins)
            .map(|(rate, temperature)| Pair { temperature: temperature.mean, rate: rate.mean })
            .filter(|p| aligned && p.temperature.is_finite() && p.rate.is_finite())
            .collect();
        let length = (both.len() / parts.max(1)).max(1);
        let mean = |part: &[Pair]| {
            let n = part.len() as f64;
            Pair {
                temperature: part.iter().map(|p| p.temperature).sum::<f64>() / n,
                rate: part.iter().map(|p| p.rate).sum::<f64>() / n,
            }
        };
        both.chunks_exact(length).map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::envelope::EnvelopeAccumulator;

    #[test]
    fn parts_hold_the_means_of_both() {
        let envelope = |values: &[f64]| {
            let mut all = EnvelopeAccumulator::new();
            all.push(values, 0);
            all.finish()
        };
        let course = Course { rate: envelope(&[1.0, 3.0, 5.0, 7.0]), temperatures: vec![] };
        let pairs = course.beside(&envelope(&[20.0, 22.0, 24.0, f64::NAN]), 1);
        assert_eq!(pairs, [Pair { temperature: 22.0, rate: 3.0 }]);
        assert_eq!(course.beside(&Envelope::default(), 2), []);
    }
}
