//! Whether the powers of an evidence scatter as those of noise do.
//!
//! The powers of noise scatter from one bin to the next, however steep its spectrum is. Those of a ramp, a slow sine or an exponential lie
//! on a smooth curve: what such a record shows over a range of frequencies is the leakage from its ends.

use super::bands::FineBin;
use super::spectrum::Evidence;

/// Bins from one to the next that is compared: the modes of what has different ends alternate.
const STRIDE: usize = 2;
/// Bend over the scatter of noise below which three bins count as smooth.
const SMOOTH_BEND: f64 = 0.1;
/// Share of smooth bins from which an octave does not scatter; of noise a fourteenth are smooth.
const SMOOTH_SHARE: f64 = 0.5;
/// Bins from which an octave says anything: a sine bends the curve over some ten.
const MIN_BINS: usize = 20;

/// The bins of an octave of one transform, and the smooth ones of them.
#[derive(Debug, Clone, Copy)]
struct Octave {
    piece: u32,
    below_hz: f64,
    bins: usize,
    smooth: usize,
}

impl Octave {
    /// The octave that begins with a bin.
    fn from(bin: &FineBin) -> Octave {
        Octave { piece: bin.piece, below_hz: 2.0 * bin.frequency_hz, bins: 0, smooth: 0 }
    }

    fn holds(&self, bin: &FineBin) -> bool {
        self.piece == bin.piece && bin.frequency_hz < self.below_hz
    }

    /// Whether its bins scatter; `None` where they are too few.
    fn scatters(&self) -> Option<bool> {
        (self.bins >= MIN_BINS).then_some(self.smooth as f64 <= SMOOTH_SHARE * self.bins as f64)
    }
}

impl Evidence {
    /// True unless the powers lie on a smooth curve in every octave. An expected evidence, which has no bins, says nothing against it.
    pub fn scatters(&self) -> bool {
        let Some(lowest) = self.fine.first() else { return true };
        let (mut octave, mut is_smooth) = (Octave::from(lowest), false);
        for (first, bin) in self.fine.iter().enumerate() {
            if !octave.holds(bin) {
                // Noise is seen in its lowest octaves, and no more of it is looked at.
                match octave.scatters() {
                    Some(true) => return true,
                    Some(false) => is_smooth = true,
                    None => {}
                }
                octave = Octave::from(bin);
            }
            let at = |i: usize| self.fine.get(first + i * STRIDE);
            let (Some(b), Some(c)) = (at(1), at(2)) else { break };
            if let Some(bend) = relative_bend([bin, b, c]) {
                octave.bins += 1;
                octave.smooth += usize::from(bend < SMOOTH_BEND);
            }
        }
        octave.scatters().unwrap_or(!is_smooth)
    }
}

/// The second difference of the logarithms of three powers over its standard deviation in noise; `None` where they do not follow each
/// other in one transform or one is zero.
fn relative_bend([a, b, c]: [&FineBin; 3]) -> Option<f64> {
    let follows = |low: &FineBin, high: &FineBin| {
        low.piece == high.piece && low.index + STRIDE as u32 == high.index && low.dof == high.dof
    };
    let positive = [a, b, c].iter().all(|bin| bin.power > 0.0 && bin.frequency_hz > 0.0);
    if !positive || !follows(a, b) || !follows(b, c) {
        return None;
    }
    let bend = (a.power * c.power / (b.power * b.power)).ln();
    // Variance of the logarithm of χ² with ν degrees of freedom: ψ₁(ν/2).
    let half = 0.5 * b.dof;
    let variance = half.recip() + 0.5 / half.powi(2) + half.powi(3).recip() / 6.0;
    bend.is_finite().then(|| bend.abs() / (6.0 * variance).sqrt())
}

#[cfg(test)]
mod tests {
    use crate::noise::data::BlockSeries;
    use crate::noise::evidence::Evidence;
    use crate::noise::model::NoiseModel;
    use crate::noise::simulate::{Setup, Simulator};

    const SAMPLES: usize = 20_000;

    /// A course over time with its name.
    type Named = (&'static str, fn(f64) -> f64);

    /// What samples at 1 Hz show.
    fn evidence_of(rate: impl Fn(f64) -> f64) -> Evidence {
        let mean: Vec<f64> = (0..SAMPLES).map(|i| rate(i as f64)).collect();
        let count = vec![1; mean.len()];
        let blocks = BlockSeries { block_len: 1, first_index: 0, count, mean, rounding: vec![] };
        Evidence::new(&blocks, None, 1.0, &[])
    }

    #[test]
    fn powers_of_a_smooth_course_do_not_scatter() {
        let courses: [Named; 4] = [
            ("ramp", |t| 1e9 * t),
            ("square of the time", |t| t * t),
            ("sine", |t| (1e-3 * t).sin()),
            ("exponential", |t| (-t / 500.0).exp()),
        ];
        for (name, course) in courses {
            assert!(!evidence_of(course).scatters(), "{name}");
        }
    }

    #[test]
    fn powers_of_noise_scatter_however_steep_they_are_and_under_any_course() {
        let model = |n: f64, b: f64, k: f64| NoiseModel { n, b, k, ..NoiseModel::default() };
        for (seed, model) in
            [model(0.002, 0.0, 0.0), model(0.0, 0.01, 0.0), model(0.0, 0.0, 0.1)].iter().enumerate()
        {
            let noise =
                Simulator::new(model, &Setup::for_record(seed as u64, 1.0, SAMPLES as u64)).take(SAMPLES);
            let at = |t: f64| noise.get(t as usize).copied().unwrap_or(0.0);
            assert!(evidence_of(at).scatters(), "{model:?}");
            assert!(evidence_of(at).up_to(0.5 / 64.0).scatters(), "{model:?}");
            assert!(evidence_of(|t| at(t) + 1e3 * (-t / 500.0).exp()).scatters(), "{model:?}");
        }
    }

    #[test]
    fn an_expected_evidence_scatters() {
        let model = NoiseModel { n: 0.002, ..NoiseModel::default() };
        assert!(Evidence::expected(&model, 36_000, 1.0).scatters());
    }
}
