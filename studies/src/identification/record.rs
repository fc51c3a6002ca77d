//! A record the way the program takes one: through the streaming digest, the search for lines, the identification.

use sagnac::noise::composite::Sampling;
use sagnac::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use sagnac::noise::identification::RangedIdentification;
use sagnac::noise::lines::{FALSE_ALARM_RATE, find_lines};
use sagnac::noise::spectral_record::SpectralRecord;

/// Digest of samples at an interval in s.
pub fn digest(y: &[f64], tau0_s: f64) -> RateDigest {
    let mut accumulator = RateAccumulator::new(DigestPlan::new(tau0_s));
    for (k, block) in y.chunks(8192).enumerate() {
        accumulator.push(block, (8192 * k) as u64, k > 0);
    }
    accumulator.finish()
}

/// Terms of the noise of a digest.
pub fn identify(digest: &RateDigest) -> RangedIdentification {
    let lines = find_lines(&digest.welch.spectrum, digest.tau0_s, FALSE_ALARM_RATE).lines;
    SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s: digest.tau0_s,
        lines: &lines,
        sampling: Sampling::Averaging,
    }
    .identify("rate")
    .ranged
}
