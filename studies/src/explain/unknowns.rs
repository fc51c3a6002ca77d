//! Effects of no catalogue, half of them: those that development may look at.

use super::draw::Draw;
use super::effect::{Effect, Process, White, means, unit};
use super::modes::gaussian;
use super::setting::Setting;
use std::f64::consts::TAU;

/// A frequency with room about it, Hz.
pub fn carrier(draw: &mut Draw, s: &Setting) -> f64 {
    draw.log_uniform(60.0 / s.duration_s(), 0.35 * s.claim.rate_hz)
}

/// A line whose strength beats, with sidebands that are coherent.
pub fn am_line(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f = carrier(draw, s);
    let beat = draw.uniform(4.0, 12.0) / s.duration_s();
    let (p, q, size) = (draw.uniform(0.0, TAU), draw.uniform(0.0, TAU), 1.4 * a * unit(s));
    let course = means(s, |t| size * (1.0 + 0.9 * (TAU * beat * t + q).cos()) * (TAU * f * t + p).cos());
    Effect::of("am_line").adding(course).found("frequency", f - 1.5 * beat, f + 1.5 * beat)
}

/// A sinusoid whose frequency climbs.
pub fn chirp(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let (f0, factor) = (carrier(draw, s) / 3.0, draw.uniform(1.5, 3.0));
    let (p, size) = (draw.uniform(0.0, TAU), 1.4 * a * unit(s));
    let growth = (factor - 1.0) / s.duration_s();
    let course = means(s, |t| size * (TAU * f0 * t * (1.0 + 0.5 * growth * t) + p).cos());
    Effect::of("chirp").adding(course).found("frequency", f0, factor * f0)
}

/// A short blip, up and down, at even intervals.
pub fn glitch_train(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let period = s.duration_s() / draw.uniform(20.0, 60.0);
    let width = (period * draw.uniform(0.02, 0.05)).max(1.5 * s.interval_s());
    let (start, size) = (draw.uniform(0.0, period), 5.0 * a * unit(s));
    let course = means(s, |t| {
        let x = ((t - start).rem_euclid(period) - 0.5 * period) / width;
        size * x * (-0.5 * x * x).exp()
    });
    Effect::of("glitch_train").adding(course).found_in_time(s).found(
        "frequency",
        0.5 / period,
        (1.0 / width).min(0.5 * s.claim.rate_hz),
    )
}

/// Logarithm of Γ (Lanczos, g = 7).
fn ln_gamma(x: f64) -> f64 {
    const C: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let t = x + 7.5;
    let sum: f64 = C[0] + (1..9).map(|i| C[i] / (x + i as f64)).sum::<f64>();
    0.5 * TAU.ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// Divergence of Student's t of variance 1 from the standard normal, per sample.
pub fn divergence_of_tails(nu: f64) -> f64 {
    let scale = ((nu - 2.0) / nu).sqrt();
    let constant = ln_gamma(0.5 * (nu + 1.0)) - ln_gamma(0.5 * nu) - 0.5 * (nu * TAU / 2.0).ln() - scale.ln();
    let ln_t = |x: f64| constant - 0.5 * (nu + 1.0) * (1.0 + (x / scale).powi(2) / nu).ln();
    let ln_n = |x: f64| -0.5 * (TAU.ln() + x * x);
    // x = sinh(3u) spreads the points over the tails.
    let h = 1e-3;
    let point = |u: f64| {
        let x = (3.0 * u).sinh();
        let l = ln_t(x);
        l.exp() * (l - ln_n(x)) * 3.0 * (3.0 * u).cosh()
    };
    (-3000..=3000).map(|i| point(h * f64::from(i)) * h).sum()
}

/// White noise with tails heavier than normal.
pub fn heavy_tails(_: &mut Draw, s: &Setting, a: f64) -> Effect {
    let nu = 2.5 + 20.0 / a;
    let sigma = s.claim.white_sigma();
    let mut effect =
        Effect::of("heavy_tails").found("amplitude", 2.0 * sigma, 100.0 * sigma).found_in_time(s);
    effect.own_gain = Some(s.rows as f64 * divergence_of_tails(nu));
    effect.white = Some(White::Tails(nu));
    effect
}

/// Noise half way between white and flicker.
pub fn half_power_noise(_: &mut Draw, s: &Setting, a: f64) -> Effect {
    let (low, high) = (0.5 / s.duration_s(), 0.5 * s.claim.rate_hz);
    let at_1_hz = 0.2 * a * 3600.0 * s.claim.n.powi(2) * (low * high).powf(0.25);
    let mut effect = Effect::of("half_power_noise").found("frequency", low, high);
    effect.process = Some(Process::HalfPower { at_1_hz });
    effect
}

/// Noise of one band, its share of the claimed variance `share` at its height, shaped in time by `shape` of 0 to 1.
pub fn band_noise(
    draw: &mut Draw,
    s: &Setting,
    (f, half): (f64, f64),
    share: f64,
    shape: impl Fn(f64) -> f64,
) -> (Vec<f64>, f64) {
    let rate = s.claim.rate_hz;
    let density =
        |x: f64| if (x - f).abs() < half { share * s.claim.mode_variance(x, [0.0; 3]) / rate } else { 0.0 };
    let noise = gaussian(draw, s.rows, rate, density);
    let course = noise.iter().zip(&s.time_s).map(|(y, &t)| y * shape(t)).collect();
    // So many modes of the band fall on each row; each is told from the claim by its variance.
    let modes = 2.0 * 2.0 * half * s.interval_s();
    let gain = |t: &f64| {
        let ratio = 1.0 + share * shape(*t).powi(2);
        0.5 * (ratio - 1.0 - ratio.ln())
    };
    (course, modes * s.time_s.iter().map(gain).sum::<f64>())
}

/// Noise of one band that swells and fades.
pub fn band_modulated_noise(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f = draw.uniform(0.08, 0.4) * s.claim.rate_hz;
    let half = f * draw.uniform(0.05, 0.15);
    let (cycles, phase) = (draw.uniform(2.0, 6.0) / s.duration_s(), draw.uniform(0.0, TAU));
    let shape = |t: f64| 0.5 * (1.0 + (TAU * cycles * t + phase).sin());
    let (course, gain) = band_noise(draw, s, (f, half), a, shape);
    let mut effect = Effect::of("band_modulated_noise").adding(course).found("frequency", f - half, f + half);
    effect.own_gain = Some(gain);
    effect
}

/// The product of two columns' departures.
pub fn temperature_supply_product(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let (thermal, supply) = (s.drivers.any_thermal(), s.drivers.supply.as_ref());
    let (thermal, supply) = (thermal.expect("temperature"), supply.expect("supply"));
    let scaled = |x: Vec<f64>| {
        let (low, high) = super::slow::range(&x);
        x.into_iter().map(move |v| 2.0 * (v - low) / (high - low) - 1.0)
    };
    let t = scaled(s.time_s.iter().map(|&t| thermal.at(t)).collect());
    let v = scaled(s.time_s.iter().map(|&t| supply.at(t)).collect());
    let size = draw.sign() * 3.0 * a * unit(s);
    let course = t.zip(v).map(|(t, v)| size * t * v).collect();
    let (cold, hot) = super::slow::range(&s.time_s.iter().map(|&t| thermal.at(t)).collect::<Vec<_>>());
    let (least, most) = super::slow::range(&s.time_s.iter().map(|&t| supply.at(t)).collect::<Vec<_>>());
    Effect::of("temperature_supply_product")
        .adding(course)
        .found("temperature", cold, hot)
        .found("supply", least, most)
        .found_in_time(s)
}

/// A drift that goes in equal steps at unequal times.
pub fn staircase_drift(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let count = 4 + draw.below(6);
    let mut at: Vec<f64> = (0..count).map(|_| draw.uniform(0.03, 0.97) * s.duration_s()).collect();
    at.sort_by(f64::total_cmp);
    let step = draw.sign() * a * unit(s);
    let course = means(s, |t| step * at.partition_point(|&x| x < t) as f64);
    Effect::of("staircase_drift").adding(course).found_in_time(s)
}
