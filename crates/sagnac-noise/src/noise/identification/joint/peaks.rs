//! Where a narrow resonance may be: the whitened bins looked through at every width.

use crate::noise::evidence::{Evidence, Zone};
use crate::numeric::order::SortByNumber;

/// A place that stands out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    pub(super) zone: Zone,
    /// Gain in 2 ln L of a resonance there over the density given.
    pub(super) gain: f64,
}

/// Bins left out at the low end, where slow noise rules.
const FIRST_BIN: usize = 4;
/// Half widths looked at reach this share of the frequency.
const MAX_RELATIVE_WIDTH: f64 = 0.15;
/// Reach of a template in half widths.
const TEMPLATE_REACH: usize = 6;
/// Score from which a gain is computed.
const MIN_SCORE: f64 = 3.0;

/// The strongest peaks, strongest first, at most `count` and none within another's width. `density` is the expected
/// density of each band of `evidence`, that bins are compared with.
pub(super) fn strongest(evidence: &Evidence, density: &[f64], count: usize) -> Vec<Peak> {
    let mut found: Vec<Peak> = vec![];
    for run in runs(evidence) {
        scan(evidence, &run, density, &mut found);
    }
    found.sort_descending_by(|a| a.gain);
    let mut kept: Vec<Peak> = vec![];
    for peak in found {
        let apart = |other: &Peak| {
            let width = 3.0 * (peak.zone.half_width_hz + other.zone.half_width_hz);
            (peak.zone.centre_hz - other.zone.centre_hz).abs() > width
        };
        if kept.iter().all(apart) {
            kept.push(peak);
            if kept.len() == count {
                break;
            }
        }
    }
    kept
}

/// Runs of neighbouring bins of one transform.
fn runs(evidence: &Evidence) -> Vec<std::ops::Range<usize>> {
    let fine = evidence.fine();
    let mut out = vec![];
    let mut start = 0;
    for i in 1..=fine.len() {
        let breaks = fine.get(i).is_none_or(|b| {
            let before = fine.get(i - 1);
            before.is_some_and(|a| !a.precedes(b))
        });
        if breaks {
            if i - start >= 8 {
                out.push(start..i);
            }
            start = i;
        }
    }
    out
}

fn scan(evidence: &Evidence, run: &std::ops::Range<usize>, density: &[f64], found: &mut Vec<Peak>) {
    let Some(bins) = evidence.fine().get(run.clone()) else { return };
    let (Some(first), Some(last)) = (bins.first(), bins.last()) else { return };
    let step = (last.frequency_hz - first.frequency_hz) / (bins.len() - 1) as f64;
    let ratio = whitened(evidence, bins.iter().map(|b| (b.frequency_hz, b.power)), density);
    // Running sums let wide templates be boxes: Σ dof (w − 1) and Σ dof.
    let mut sums = Vec::with_capacity(bins.len() + 1);
    let mut total = 0.0;
    sums.push(0.0);
    for (w, b) in ratio.iter().zip(bins) {
        total += b.dof * (w - 1.0);
        sums.push(total);
    }
    let dof = first.dof;
    let from = FIRST_BIN.saturating_sub((first.frequency_hz / step) as usize);
    let mut half = 1usize;
    while half * TEMPLATE_REACH < bins.len() {
        let stride = (half / 2).max(1);
        for centre in (from..bins.len()).step_by(stride) {
            let frequency = first.frequency_hz + centre as f64 * step;
            if half as f64 * step > MAX_RELATIVE_WIDTH * frequency {
                continue;
            }
            let (a, b) = (centre.saturating_sub(half), (centre + half + 1).min(bins.len()));
            let score = (sums[b] - sums[a]) / (2.0 * dof * (b - a) as f64).sqrt();
            if score < MIN_SCORE {
                continue;
            }
            let zone = Zone { centre_hz: frequency, half_width_hz: half as f64 * step * 0.5 };
            let gain = gain_of(&ratio, centre, 0.5 * half as f64, dof);
            if gain > 4.0 {
                found.push(Peak { zone, gain });
            }
        }
        half *= 2;
    }
}

/// Gain in 2 ln L of the best amplitude of a Lorentzian of half width `half` bins.
fn gain_of(ratio: &[f64], centre: usize, half: f64, dof: f64) -> f64 {
    let reach = ((2 * TEMPLATE_REACH) as f64 * half).ceil() as usize + 2;
    let (a, b) = (centre.saturating_sub(reach), (centre + reach + 1).min(ratio.len()));
    // Wide templates are summed in groups of bins.
    let group = ((half / 4.0) as usize).max(1);
    let mut parts: Vec<(f64, f64, f64)> = vec![];
    let mut i = a;
    while i < b {
        let end = (i + group).min(b);
        let Some(slice) = ratio.get(i..end) else { break };
        let mean = slice.iter().sum::<f64>() / slice.len() as f64;
        let middle = (i + end - 1) as f64 * 0.5;
        let x = (middle - centre as f64) / half.max(0.5);
        parts.push((1.0 / (1.0 + x * x), mean, dof * slice.len() as f64));
        i = end;
    }
    let gain = |amplitude: f64| -> f64 {
        parts
            .iter()
            .map(|(t, w, d)| {
                let s = 1.0 + amplitude * t;
                d * (w - w / s - s.ln())
            })
            .sum()
    };
    // One variable, one maximum: Fisher scoring from the moment estimate.
    let (mut amplitude, mut best) = (0.0f64, 0.0f64);
    for _ in 0..12 {
        let (mut score, mut information) = (0.0, 0.0);
        for (t, w, d) in &parts {
            let s = 1.0 + amplitude * t;
            score += d * t * (w - s) / (s * s);
            information += d * t * t / (s * s);
        }
        let next = (amplitude + score / information.max(1e-300)).max(0.0);
        let value = gain(next);
        if value <= best + 1e-3 {
            best = best.max(value);
            break;
        }
        (amplitude, best) = (next, value);
    }
    best
}

/// Powers over the expected density, interpolated between the bands.
fn whitened(evidence: &Evidence, bins: impl Iterator<Item = (f64, f64)>, density: &[f64]) -> Vec<f64> {
    let knots: Vec<(f64, f64)> = evidence
        .bands
        .iter()
        .zip(density)
        .filter(|(_, s)| **s > 0.0)
        .map(|(b, s)| (0.5 * (b.low_hz + b.high_hz), s.ln()))
        .collect();
    let mut at = 0;
    bins.map(|(f, power)| {
        while at + 2 < knots.len() && knots.get(at + 1).is_some_and(|k| k.0 < f) {
            at += 1;
        }
        let (Some(a), Some(b)) = (knots.get(at), knots.get(at + 1)) else { return 1.0 };
        let share = if b.0 > a.0 { ((f - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { 0.0 };
        power / (a.1 + share * (b.1 - a.1)).exp()
    })
    .collect()
}
