//! The noise that edges are simulated with, against closed forms.

use sagnac_studies::bench::noise_source::NoiseSource;

/// Mean square of the difference of neighbouring means of `m` samples, halved: the Allan variance.
fn allan_variance(x: &[f64], m: usize) -> f64 {
    let means: Vec<f64> = x.chunks_exact(m).map(|c| c.iter().sum::<f64>() / m as f64).collect();
    means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>() / (2.0 * (means.len() - 1) as f64)
}

#[test]
fn each_noise_has_the_allan_variance_of_its_closed_form() {
    let mut source = NoiseSource::new(1);
    let len = 1 << 18;
    let tau_h = 256.0 / 3600.0;
    for (x, expected) in [
        (source.white(0.01, 1.0, len), 0.01f64.powi(2) / tau_h),
        (source.flicker(0.1, 1.0, len), 0.1f64.powi(2) * 2.0 * 2f64.ln() / std::f64::consts::PI),
        (source.walk(0.1, 1.0, len), 0.1f64.powi(2) * tau_h / 3.0),
    ] {
        let ratio = allan_variance(&x, 256) / expected;
        assert!((0.85..1.15).contains(&ratio), "{ratio}");
    }
}
