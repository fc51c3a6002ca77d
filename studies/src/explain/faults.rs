//! Faults of the output and of the file: rounding, outliers, rows that are missing.

use super::draw::Draw;
use super::effect::Effect;
use super::setting::Setting;

/// The angle comes in steps. The gain stated is that of the spectrum; the lattice of values tells more.
pub fn quantization(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let lsb = a * draw.log_uniform(1.0, 4.0) * s.claim.white_sigma() * s.interval_s();
    let step = lsb * s.claim.rate_hz;
    let mut effect = Effect::of("quantization").with("lsb_arcsec", lsb);
    effect = effect.found("amplitude", 0.0, 2.0 * step).found("frequency", 0.0, 0.5 * s.claim.rate_hz);
    effect.lsb_arcsec = lsb;
    effect
}

/// Groups of samples far out.
pub fn outlier_bursts(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let groups = ((2.0 * a).round() as usize).max(2);
    let sigma = s.claim.white_sigma();
    let mut course = vec![0.0; s.rows];
    let mut effect = Effect::of("outlier_bursts").with("count", groups as f64);
    let mut begun: Vec<usize> = Vec::new();
    let mut outlying = 0;
    while begun.len() < groups {
        let at = 50 + draw.below(s.rows - 120);
        if begun.iter().any(|&b| b.abs_diff(at) < s.rows / (8 * groups)) {
            continue;
        }
        begun.push(at);
        let length = 1 + draw.below(3);
        for row in course.iter_mut().skip(at).take(length) {
            *row = draw.sign() * sigma * draw.uniform(4.5, 8.0);
            outlying += 1;
        }
        let (from, to) = (s.time_s[at], s.time_s[at + length - 1]);
        let around = 2.0 * s.interval_s();
        effect = effect.found("time", from - around, to + around);
    }
    // Where they are must be searched for, and how large each is.
    effect.cost = groups as f64 * (s.rows as f64 / groups as f64).ln() + outlying as f64 * 2.0;
    effect.found("amplitude", 3.0 * sigma, 12.0 * sigma).adding(course)
}

/// Rows missing.
pub fn dropped_samples(draw: &mut Draw, s: &Setting, _: f64) -> Effect {
    let mut gone = Vec::new();
    let mut effect = Effect::of("dropped_samples");
    for _ in 0..1 + draw.below(4) {
        let at = 10 + draw.below(s.rows - 400);
        let length = draw.log_uniform(1.0, 300.0) as usize;
        gone.extend(at..at + length);
        let around = s.interval_s();
        effect = effect.found("timestamps", s.time_s[at] - around, s.time_s[at + length] + around);
        effect = effect.found("time", s.time_s[at] - around, s.time_s[at + length] + around);
    }
    gone.sort_unstable();
    gone.dedup();
    let mut effect = effect.with("missing_rows", gone.len() as f64);
    // One gap is proof.
    effect.own_gain = Some(f64::INFINITY);
    effect.dropped = gone;
    effect
}
