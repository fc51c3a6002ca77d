//! The part of an evidence that is usable behind a moving average.

use super::model::Extras;
use crate::noise::composite::{Bandwidth, averaged_white_mode};
use crate::noise::evidence::{Evidence, Zone};
use std::f64::consts::PI;

/// Share of a mode's power that the ends of the record may make.
const MAX_SHARE_OF_ENDS: f64 = 0.05;

/// Power that a mean over so many samples lets through at a frequency in cycles a sample.
fn gain(samples: u32, x: f64) -> f64 {
    let n = f64::from(samples);
    let x = PI * x;
    if x.sin().abs() < 1e-12 { 1.0 } else { ((n * x).sin() / (n * x.sin())).powi(2) }
}

/// What the likelihood may take as independent. About the zeros of a moving average the modes of a record hold the few
/// samples at its ends and little else: all of them the same, so that they are left out, and bands next to them are
/// narrow, for the power falls to nothing within them.
pub(super) fn usable_evidence(evidence: &Evidence, extras: &Extras) -> Evidence {
    let Some(Bandwidth::MovingAverage { samples }) = extras.shape.filter else {
        return evidence.resolving(&extras.zones);
    };
    let tau0_s = evidence.tau0_s;
    let by_ends = |tau_s: f64, mode: usize, blocks: usize| {
        tau_s < 1.5 * tau0_s && {
            let all = averaged_white_mode(samples, mode as f64, blocks);
            gain(samples, mode as f64 / (2.0 * blocks as f64)) < (1.0 - MAX_SHARE_OF_ENDS) * all
        }
    };
    let span = evidence.span_s.max(tau0_s);
    // At this distance from a zero the power is that of the ends, about 1/(samples in the record).
    let half_width_hz = (tau0_s / span).sqrt() / tau0_s / f64::from(samples);
    let zeros = (1..=samples / 2).map(|k| {
        let centre_hz = f64::from(k) / (f64::from(samples) * tau0_s);
        Zone { centre_hz, half_width_hz }
    });
    let zones: Vec<Zone> = extras.zones.iter().copied().chain(zeros).collect();
    evidence.leaving_out(by_ends).resolving(&zones)
}

#[cfg(test)]
mod tests {
    use super::super::columns::expected_power;
    use super::super::model::Shape;
    use super::*;
    use crate::noise::composite::{Composite, Sampling};
    use crate::noise::data::BlockSeries;
    use crate::noise::model::NoiseModel;
    use rand::SeedableRng as _;
    use rand_distr::{Distribution as _, StandardNormal};

    #[test]
    fn bands_behind_a_moving_average_have_the_power_of_their_expectation() {
        let (n, length, records) = (36_000usize, 4u32, 60u64);
        let filter = Some(Bandwidth::MovingAverage { samples: length });
        let extras = Extras { shape: Shape { filter, damped: vec![] }, zones: vec![] };
        let terms = NoiseModel { n: 1.0 / 60.0, ..NoiseModel::default() };
        let model =
            Composite { terms, bandwidth: filter, sampling: Sampling::Averaging, ..Composite::default() };
        let mut sums: Vec<(f64, f64)> = vec![];
        for seed in 0..records {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(900 + seed);
            let white: Vec<f64> = (0..n + length as usize).map(|_| StandardNormal.sample(&mut rng)).collect();
            let mean = white
                .windows(length as usize)
                .map(|w| w.iter().sum::<f64>() / f64::from(length))
                .take(n)
                .collect();
            let blocks = BlockSeries { block_len: 1, mean, count: vec![1; n], ..BlockSeries::default() };
            let evidence = usable_evidence(&Evidence::new(&blocks, None, 1.0, &[]), &extras);
            let expected = expected_power(&evidence, &model);
            sums.resize(evidence.bands.len(), (0.0, 0.0));
            for ((sum, band), e) in sums.iter_mut().zip(&evidence.bands).zip(&expected) {
                *sum = (sum.0 + band.power / e / records as f64, band.dof * records as f64);
            }
        }
        for (ratio, dof) in &sums {
            let z = (ratio - 1.0) * (0.5 * dof).sqrt();
            // Bands whose power falls to nothing within them count for fewer modes than they have.
            assert!(z.abs() < 5.0, "{ratio} with {dof} degrees of freedom");
        }
        let dof: f64 = sums.iter().map(|s| s.1).sum();
        let excess = sums.iter().map(|s| (s.0 - 1.0) * s.1).sum::<f64>() / dof;
        assert!(excess.abs() < 4.0 * (2.0 / dof).sqrt(), "{excess}");
        assert!(dof > 0.98 * records as f64 * n as f64, "{dof} left");
    }
}
