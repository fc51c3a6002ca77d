//! White noise in zones of temperature, from second differences of short means, which no steady ramp moves.

use super::test::TemperatureTest;
use super::track::Means;

/// Second differences that a zone needs.
const LEAST: usize = 30;
/// Samples in a mean at least where the sample rate allows: filters act on fewer.
const SAMPLES: u64 = 8;
/// Shortest and longest mean aimed at, s.
const LENGTH_S: (f64, f64) = (1.0, 10.0);

/// The noise in one zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Middle of the zone, degC.
    pub deg_c: f64,
    /// N, deg/sqrt(h); `None` where the record holds too little there.
    pub n: Option<f64>,
    /// Degrees of freedom of its square.
    pub dof: f64,
    /// Length of the means, s.
    pub average_s: f64,
    /// Second differences.
    pub count: usize,
}

/// The zones that are asked for.
pub fn zones(means: &Means, rate: usize, temperature: usize, test: &TemperatureTest) -> Vec<Zone> {
    let by_samples = SAMPLES.div_ceil(means.samples) as usize;
    let by_length = (LENGTH_S.0 / means.block_s).ceil() as usize;
    let longest = ((LENGTH_S.1 / means.block_s) as usize).max(1);
    let short = means.merged(by_samples.max(by_length).clamp(1, longest));
    let (Some(y), Some(t)) = (short.values.get(rate), short.values.get(temperature)) else { return vec![] };
    let centres = &test.zones_deg_c;
    let zone_of = |deg_c: f64| {
        let nearest = centres.iter().enumerate().min_by(|a, b| {
            let off = |c: &f64| (c - deg_c).abs();
            off(a.1).total_cmp(&off(b.1))
        });
        nearest.map(|(i, _)| i)
    };
    let mut sums = vec![(0.0, 0usize); centres.len()];
    for (w, t) in y.windows(3).zip(t.windows(3)) {
        let second = w[2] - 2.0 * w[1] + w[0];
        if let Some(zone) = zone_of(t[1]).filter(|_| second.is_finite() && t[1].is_finite()) {
            // A zone reaches half way to its neighbours, and as far beyond the outermost.
            let gap = centres
                .iter()
                .enumerate()
                .filter(|(i, _)| *i != zone)
                .map(|(_, c)| (c - centres[zone]).abs())
                .fold(f64::INFINITY, f64::min);
            if (t[1] - centres[zone]).abs() <= 0.5 * gap.min(50.0) {
                sums[zone].0 += second * second;
                sums[zone].1 += 1;
            }
        }
    }
    centres
        .iter()
        .zip(sums)
        .map(|(&deg_c, (sum, count))| {
            // White means of variance σ² have second differences of 6 σ², correlated by −4/6 and 1/6.
            let variance = sum / (6.0 * count.max(1) as f64);
            Zone {
                deg_c,
                n: (count >= LEAST && variance > 0.0).then(|| (variance * short.block_s / 3600.0).sqrt()),
                dof: count as f64 / (1.0 + 2.0 * (16.0 / 36.0 + 1.0 / 36.0)),
                average_s: short.block_s,
                count,
            }
        })
        .collect()
}
